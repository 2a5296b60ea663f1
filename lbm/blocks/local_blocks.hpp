#pragma once
// The blocks of a rank, as populations of any lattice are stored in them.
#include <algorithm>
#include <span>
#include <vector>

#include "lbm/blocks/block.hpp"
#include "lbm/blocks/domain.hpp"

namespace silt::lbm {

/// Appends blocks that share arrays. Blocks of a coarse level lie between finer boxes; blocks in one array
/// need no exchange among them. At least half of the cells of an array belong to its blocks.
template <class T, class Lattice>
void add_shared(std::span<const BlockPlace> places, Device device, std::vector<Block<T, Lattice>>& blocks) {
  Int3 low = places[0].box.lower, high = low;
  std::int64_t cells = 0;
  for (const BlockPlace& place : places) {
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], place.box.lower[d]);
      high[d] = std::max(high[d], place.box.lower[d] + place.box.size[d]);
    }
    cells += place.box.cells();
  }
  const CellBox all{low, high - low};
  if (2 * cells >= all.cells()) {
    const Block<T, Lattice> whole(all, device);
    for (const BlockPlace& place : places) blocks.emplace_back(whole, place.box);
  } else {
    add_shared(places.first(places.size() / 2), device, blocks);
    add_shared(places.subspan(places.size() / 2), device, blocks);
  }
}

/// Makes the local blocks. Those of level 0 share no array: cut links write cells that other blocks hold.
template <class T, class Lattice>
std::vector<Block<T, Lattice>> local_blocks(const Domain& domain, int rank, Device device) {
  const std::vector<BlockPlace> places = domain.blocks_of(rank);
  std::vector<Block<T, Lattice>> blocks;
  if (domain.level() > 0 && !places.empty())
    add_shared<T, Lattice>(places, device, blocks);
  else
    for (const BlockPlace& place : places) blocks.emplace_back(place.box, device);
  return blocks;
}

}  // namespace silt::lbm

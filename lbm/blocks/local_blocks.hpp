#pragma once
// The blocks of a rank, as populations of any lattice are stored in them.
#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "lbm/blocks/block.hpp"
#include "lbm/blocks/domain.hpp"

namespace silt::lbm {

/// Returns a block of all cells of an array: a new one, or that of a block of `before` if it was made for
/// this box and none of `blocks` has it.
template <class T, class Lattice>
Block<T, Lattice> whole_array(const CellBox& box, Device device, std::span<const Block<T, Lattice>> before,
                              const std::vector<Block<T, Lattice>>& blocks) {
  const auto same = std::ranges::find_if(before, [&](const Block<T, Lattice>& one) {
    const auto has_it = [&](const Block<T, Lattice>& b) { return b.shares_array(one); };
    return one.array_box() == box && std::ranges::none_of(blocks, has_it);
  });
  return same != before.end() ? Block<T, Lattice>(*same, box) : Block<T, Lattice>(box, device);
}

/// Appends blocks that share arrays. Blocks of a coarse level lie between finer boxes; blocks in one array
/// need no exchange among them. At least half of the cells of an array belong to its blocks.
template <class T, class Lattice>
void add_shared(std::span<const BlockPlace> places, Device device, std::span<const Block<T, Lattice>> before,
                std::vector<Block<T, Lattice>>& blocks) {
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
    const Block<T, Lattice> whole = whole_array(all, device, before, blocks);
    for (const BlockPlace& place : places) blocks.emplace_back(whole, place.box);
  } else {
    add_shared(places.first(places.size() / 2), device, before, blocks);
    add_shared(places.subspan(places.size() / 2), device, before, blocks);
  }
}

/// Makes the local blocks. Those of level 0 share no array with one another: cut links write cells that other
/// blocks hold. Arrays are taken from `before`, blocks of another cut, where it has some for the same boxes.
template <class T, class Lattice>
std::vector<Block<T, Lattice>> local_blocks(const Domain& domain, int rank, Device device,
                                            std::span<const Block<T, Lattice>> before = {}) {
  const std::vector<BlockPlace> places = domain.blocks_of(rank);
  std::vector<Block<T, Lattice>> blocks;
  if (domain.level() > 0 && !places.empty())
    add_shared<T, Lattice>(places, device, before, blocks);
  else
    for (const BlockPlace& place : places) blocks.push_back(whole_array(place.box, device, before, blocks));
  return blocks;
}

}  // namespace silt::lbm

#include "lbm/walls/pairs_across.hpp"

#include <vector>

#include "lbm/exchange/ghost_home.hpp"
#include "parallel/communicator.hpp"

namespace silt::lbm {

namespace {

/// Returns the first of the two arrays of a block from which exchange() copies pairs along a direction.
template <class Lattice>
std::uint32_t source(int block, int direction) {
  return 2 * std::uint32_t(block * Lattice::directions + direction);
}

}  // namespace

template <class T, class Lattice>
struct PairsAcross<T, Lattice>::Builder {
  PairsAcross& pairs;
  const Domain& domain;
  std::span<const Block> blocks;
  struct Entry {
    int block, behind_block, direction, axis;
    Int3 x, behind;  // local to these blocks
  };
  std::vector<PlacesAcross<Lattice>> places = {};  // by local block
  Entry last{-1, -1, 0, 0, {}, {}};

  /// Returns whether a pair continues the last line. Both ends of a message find the same lines.
  bool goes_on(const Entry& one) const {
    const Int3 along = one.axis == 0 ? Int3{0, 1, 0} : Int3{1, 0, 0};
    return one.block == last.block && one.behind_block == last.behind_block &&
           one.direction == last.direction && one.axis == last.axis && one.x == last.x + along &&
           one.behind == last.behind + along;
  }

  /// Adds the pair of the link that comes from ghost cell g, against j, a cell of `behind_block` moved by
  /// `way`.
  void add(const BlockPlace& place, const BlockPlace& behind_block, Int3 way, Int3 g, int j) {
    const Int3 x = g - Lattice::c[j] - place.box.lower;
    const int i = opposite(j), axis = PlacesAcross<Lattice>::axis_of(x, Lattice::c[i], place.box.size);
    const int here = domain.local_index(place, pairs.rank_),
              there = domain.local_index(behind_block, pairs.rank_);
    if (here < 0 && there < 0) return;
    const Entry one{place.index, behind_block.index, i, axis, x, g - way - behind_block.box.lower};
    if (goes_on(one)) {
      ++pairs.lines_.back().length;
    } else {
      Line line{here, i, x, axis == 0, 1, behind_block.rank, place.rank, {}, {}};
      if (here < 0) line.block = there, line.first = one.behind + Lattice::c[i];
      if (here >= 0) line.to = {std::uint32_t(here), 2 * places[std::size_t(here)](x, i), 2};
      if (there >= 0)
        line.from = {source<Lattice>(there, i), std::uint32_t(blocks[there].cell(one.behind)),
                     std::int32_t(axis == 0 ? blocks[there].row_stride() : 1)};
      pairs.lines_.push_back(line);
    }
    last = one;
  }

  void build() {
    for (std::size_t b = 0; b < blocks.size(); ++b)
      pairs.pairs_[b].resize(places.emplace_back(blocks[b].size()).count());
    for (const int b : domain.neighbourhood_of_rank(pairs.rank_)) {
      const BlockPlace place = domain.block(b);
      const auto add_box = [&](const BlockPlace& behind, Int3 way, const CellBox& ghosts, int j) {
        if (!domain.is_of_level(behind)) return;
        for_cells(ghosts.lower, ghosts.lower + ghosts.size, [&](Int3 g) { add(place, behind, way, g, j); });
      };
      for_ghost_boxes<Lattice>(domain, place.box, add_box);
    }
  }
};

template <class T, class Lattice>
PairsAcross<T, Lattice>::PairsAcross(const Domain& domain, MPI_Comm comm, std::span<const Block> blocks,
                                     Device device)
    : rank_(parallel::rank_of(comm)),
      device_(device),
      slots_(comm, 3, device),
      sources_{Mirror<const T*>(device), Mirror<const T*>(device)},
      targets_(device) {
  for (std::size_t b = 0; b < blocks.size(); ++b) pairs_.emplace_back(memory_of(device));
  Builder{*this, domain, blocks}.build();
  for (auto& of_block : pairs_) targets_.host().push_back(reinterpret_cast<T*>(of_block.data()));
  targets_.send();
  for (const Line& line : lines_) add(line, 0, line.length);
  slots_.send_lists();
}

template <class T, class Lattice>
void PairsAcross<T, Lattice>::add(const Line& line, std::uint32_t n, std::uint32_t count) {
  SlotRun from = line.from, to = line.to;
  from.first += n * std::uint32_t(from.stride), to.first += n * std::uint32_t(to.stride);
  from.length = to.length = count;
  for (int half = 0; half < 2; ++half, ++from.array, ++to.first)  // away, toward
    slots_.add(line.from_rank, from, line.to_rank, to, rank_);
}

template <class T, class Lattice>
void PairsAcross<T, Lattice>::exchange(std::span<const Block> blocks, Parity parity) {
  std::vector<const T*> all(2 * Lattice::directions * blocks.size());
  for (int b = 0; b < int(blocks.size()); ++b)
    for (int i = 1; i < Lattice::directions; ++i) {
      all[source<Lattice>(b, i)] = blocks[b].data() + blocks[b].leaving(opposite(i), parity);
      all[source<Lattice>(b, i) + 1] = blocks[b].data() + blocks[b].arriving(i, parity);
    }
  Mirror<const T*>& sources = sources_[parity == Parity::settled];
  if (!std::ranges::equal(all, sources.host())) sources.host().assign(all.begin(), all.end()), sources.send();
  slots_.start({sources.device(), sources.size()});
  slots_.finish({sources.device(), sources.size()}, {targets_.device(), targets_.size()});
}

template class PairsAcross<float>;
template class PairsAcross<double>;

}  // namespace silt::lbm

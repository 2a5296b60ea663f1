#include "coupler/mapping/refill.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "coupler/mapping/shared_neighbours.hpp"
#include "parallel/communicator.hpp"

namespace silt::coupler {
using lbm::Int3;

namespace {

/// Calls f(cell) for the block's cells that are in a mask but not in `other` (solid cells, now or before).
template <class F>
void for_cells_lost(const BlockMap& map, const BodyMask& mask, const CellBits& other, F&& f) {
  const Int3 size = other.size();
  const BitFrame& w = mask.frame();
  for (int z = std::max(w.low.z + 2, 0); z < std::min(w.low.z + w.size.z - 2, size.z); ++z)
    for (int y = std::max(w.low.y + 2, 0); y < std::min(w.low.y + w.size.y - 2, size.y); ++y) {
      if (!map.row_changed(y, z)) continue;
      for (int x = 0; x < w.pitch; x += 64) {
        std::uint64_t lost = mask.bits.row(x, y, z);
        if (lost) lost &= ~other.from(w.low.x + x, y, z);
        for (; lost; lost &= lost - 1) {
          const int at = w.low.x + x + std::countr_zero(lost);
          if (at >= 0 && at < size.x) f(Int3{at, y, z});
        }
      }
    }
}

/// Calls visit(pair, local cell) for the cells of other ranks whose bits are set, of bits(map, y, z, word),
/// and their neighbours here that were and are fluid.
template <class T, class Bits, class Visit>
void for_pairs_with_others(const lbm::Fluid<T>& fluid, const std::vector<BlockMap>& maps, Bits&& bits,
                           Visit&& visit) {
  const lbm::Domain& domain = fluid.domain();
  const int here = parallel::rank_of(fluid.comm());
  for (int b = 0; b < int(maps.size()); ++b) {
    const BlockMap& map = maps[b];
    for_ghosts(
        map, [&](int y, int z, int k) { return bits(map, y, z, k); },
        [&](Int3 x) {
          const Int3 cell = map.box.lower + x;
          const int rank = domain.rank_at(domain.wrapped(cell));
          for (int k = 1; rank != here && k < lbm::D3Q19::directions; ++k) {
            const Int3 y = x + lbm::D3Q19::c[k];
            if (map.has(y) && map.was_and_is_fluid(y)) visit({rank, cell, k}, {b, y});
          }
        });
  }
}

/// Returns the moments of neighbours on other ranks; sends those that other ranks want.
template <class T>
std::vector<lbm::Moments> remote_moments(lbm::Fluid<T>& fluid, const std::vector<BlockMap>& maps,
                                         std::span<const RemoteNeighbour> neighbours) {
  const lbm::Domain& domain = fluid.domain();
  if (domain.ranks() == 1) return {};
  SharedNeighbours<lbm::Moments> offers(domain), wants(domain);
  std::vector<lbm::LocalCell> offered;
  for_pairs_with_others(
      fluid, maps,
      [](const BlockMap& map, int y, int z, int k) {
        return map.before.at(y, z)[k] & ~map.solid.at(y, z)[k];
      },
      [&](const RemoteNeighbour& of, const lbm::LocalCell& here) {
        offers.add(of.rank, of.cell, of.k);
        offered.push_back(here);
      });
  for (const RemoteNeighbour& of : neighbours) wants.add(of.rank, of.cell, of.k);
  return offers.exchange(fluid.comm(), 2, fluid.moments(offered), wants);
}

}  // namespace

rigid::Vec3 nearest_arm(const lbm::Domain& domain, const rigid::Vec3& position, Int3 cell) {
  rigid::Vec3 arm(cell.x + 0.5 - position[0], cell.y + 0.5 - position[1], cell.z + 0.5 - position[2]);
  for (int d = 0; d < 3; ++d)
    if (domain.periodic(d)) arm[d] -= domain.cells()[d] * std::round(arm[d] / domain.cells()[d]);
  return arm;
}

ChangedCells changed_cells(const std::vector<BlockMap>& maps) {
  ChangedCells cells;
  for (int b = 0; b < int(maps.size()); ++b) {
    const BlockMap& map = maps[b];
    if (!map.changed) continue;
    std::vector<char> kept(map.masks_before.size(), 0);
    for_masks(map.masks, [&](std::size_t k) {
      const BodyMask& mask = map.masks[k];
      if (mask.kept)
        kept[mask.before] = 1;
      else
        for_cells_lost(map, mask, map.before, [&](Int3 x) { cells.covered.push_back({b, x, &mask}); });
    });
    for_masks(map.masks_before, [&](std::size_t k) {
      const BodyMask& mask = map.masks_before[k];
      if (!kept[k])
        for_cells_lost(map, mask, map.solid, [&](Int3 x) { cells.uncovered.push_back({b, x, &mask}); });
    });
  }
  return cells;
}

std::vector<lbm::LocalCell> places(const std::vector<CoveredCell>& cells) {
  std::vector<lbm::LocalCell> all;
  all.reserve(cells.size());
  for (const CoveredCell& c : cells) all.push_back({c.block, c.cell});
  return all;
}

template <class T>
void TurnedCells<T>::list(lbm::Fluid<T>& fluid, const std::vector<BlockMap>& maps,
                          const ChangedCells& changed) {
  cells_.host().clear(), ranges_.clear();
  const auto add = [&](const std::vector<CoveredCell>& cells, int sign) {
    for (const CoveredCell& c : cells) {
      const BlockMap& map = maps[c.block];
      ChangedCell cell{std::uint32_t(fluid.blocks()[c.block].cell(c.cell)), 0};
      for (int k = 1; k < lbm::D3Q19::directions; ++k) {
        const Int3 y = c.cell + lbm::D3Q19::c[k];
        if (map.was_and_is_fluid(y)) cell.neighbours |= 1u << k | (map.has(y) ? 0 : ChangedCell::at_face);
      }
      if (ranges_.empty() || ranges_.back().block != c.block || ranges_.back().sign != sign)
        ranges_.push_back({c.block, sign, std::uint32_t(cells_.size()), 0});
      ++ranges_.back().count;
      cells_.host().push_back(cell);
    }
  };
  add(changed.uncovered, -1), add(changed.covered, +1);
  cells_.send();
}

/// Lists neighbours in other blocks, and has the moments of those of uncovered cells computed or told.
template <class T>
void TurnedCells<T>::list_faces(lbm::Fluid<T>& fluid, const std::vector<BlockMap>& maps,
                                const ChangedCells& changed) {
  const lbm::Domain& domain = fluid.domain();
  const int rank = parallel::rank_of(fluid.comm());
  faces_.host().clear(), places_.host().clear(), near_cells_.clear(), remote_.clear();
  const auto add = [&](const std::vector<CoveredCell>& cells, std::uint32_t first) {
    for (std::uint32_t n = 0; n < cells.size(); ++n) {
      const std::uint32_t neighbours = cells_.host()[first + n].neighbours;
      if (!(neighbours & ChangedCell::at_face)) continue;
      const BlockMap& map = maps[cells[n].block];
      FaceCell face{first + n, 0, std::uint32_t(places_.size())};
      for (int k = 1; k < lbm::D3Q19::directions; ++k) {
        const Int3 y = cells[n].cell + lbm::D3Q19::c[k];
        if (!(neighbours >> k & 1) || map.has(y)) continue;
        face.neighbours |= 1u << k;
        const Int3 g = domain.wrapped(map.box.lower + y);
        const lbm::BlockPlace there = domain.block_at(g);
        const int block = domain.local_index(there, rank);
        places_.host().push_back(block < 0 ? 2 * std::uint32_t(remote_.size())
                                           : 2 * std::uint32_t(near_cells_.size()) + 1);
        if (block < 0)
          remote_.push_back({domain.rank_at(g), map.box.lower + cells[n].cell, k});
        else
          near_cells_.push_back({block, g - there.box.lower});
      }
      faces_.host().push_back(face);
    }
  };
  add(changed.uncovered, 0);
  const std::size_t told = remote_.size(), near = near_cells_.size();
  add(changed.covered, std::uint32_t(changed.uncovered.size()));
  faces_.send(), places_.send();
  const std::vector<lbm::Moments> found = remote_moments(fluid, maps, std::span(remote_).first(told));
  told_.host().assign(found.begin(), found.end());
  if (near_cells_.empty()) return;
  lbm::ListedCells<T> listed = fluid.listed(near_cells_, listed_near_);
  near_.host().resize(near);
  listed.count = std::int64_t(near);
  lbm::passes_on<T>(fluid.device()).gather_moments(listed, near_.make_room());
}

template <class T>
ChangedInBlock<T> TurnedCells<T>::in_block(lbm::Fluid<T>& fluid, const Range& range) {
  return {fluid.listed_block(range.block), cells_.device() + range.first, range.count};
}

template <class T>
PassingCells<T> TurnedCells<T>::passing(lbm::Fluid<T>& fluid, const Range& range, std::int64_t* sent) {
  return {in_block(fluid, range), range.sign, range.first, masses_.device(),
          left_.device(),         sent,       faces(),     {}};
}

template <class T>
void TurnedCells<T>::refill(lbm::Fluid<T>& fluid, const std::vector<BlockMap>& maps,
                            const ChangedCells& changed, const rigid::BodySet& bodies,
                            const rigid::BodySet& gone) {
  list(fluid, maps, changed), list_faces(fluid, maps, changed);
  const auto& force = fluid.spec().force;
  momenta_.host().assign(changed.uncovered.size(), {});
  for (std::size_t n = 0; n < changed.uncovered.size(); ++n) {
    const CoveredCell& u = changed.uncovered[n];
    for (const rigid::BodySet* set : {&bodies, &gone}) {
      const std::size_t row = u.body ? set->row_of(u.body->id) : set->size();
      if (row >= set->size()) continue;
      const Int3 cell = maps[u.block].box.lower + u.cell;
      const rigid::Vec3 v = set->velocity_at(row, nearest_arm(fluid.domain(), set->position[row], cell));
      for (std::size_t d = 0; d < 3; ++d) momenta_.host()[n][d] = v[Eigen::Index(d)] - 0.5 * force[d];
    }
  }
  const MomentsElsewhere elsewhere{told_.send(), near_.device()};
  momenta_.send();
  const auto refill_block = SILT_ON(fluid.device(), refill_cells<T>);
  for (const Range& range : ranges_)
    if (range.sign < 0)
      refill_block({in_block(fluid, range), range.first, momenta_.device(), faces(), elsewhere, force});
  lbm::wait(fluid.device());
}

/// Exchanges the masses that cells pass on to neighbours on other ranks.
template <class T>
void TurnedCells<T>::take_from_others(lbm::Fluid<T>& fluid, const std::vector<BlockMap>& maps) {
  const lbm::Domain& domain = fluid.domain();
  takers_.clear(), taken_.clear();
  if (domain.ranks() == 1) return;
  SharedNeighbours<double> given(domain), wanted(domain);
  for (const RemoteNeighbour& to : remote_) given.add(to.rank, to.cell, to.k);
  for_pairs_with_others(
      fluid, maps,
      [](const BlockMap& map, int y, int z, int k) { return map.before.at(y, z)[k] ^ map.solid.at(y, z)[k]; },
      [&](const RemoteNeighbour& of, const lbm::LocalCell& here) {
        wanted.add(of.rank, of.cell, of.k);
        takers_.push_back(here);
      });
  const std::vector<double> parts(sent_.host().begin(), sent_.host().end());
  for (const double mass : given.exchange(fluid.comm(), 8, parts, wanted))
    taken_.push_back(std::int64_t(mass));
}

template <class T>
rigid::FixedSum TurnedCells<T>::weigh(lbm::Fluid<T>& fluid, const std::vector<BlockMap>& maps) {
  masses_.host().resize(cells_.size()), masses_.make_room();
  sent_.host().resize(remote_.size());
  left_.host().assign(1, 0);
  if (!ranges_.empty()) {
    left_.clear();
    std::int64_t* const sent = remote_.empty() ? nullptr : sent_.make_room();
    for (const Range& range : ranges_) SILT_ON(fluid.device(), weigh_cells<T>)(passing(fluid, range, sent));
    left_.fetch(), sent_.fetch(), lbm::wait(fluid.device());
  }
  take_from_others(fluid, maps);
  return std::llrint(double(left_.host()[0]) * lbm::excess_quantum<T> / lbm::mass_quantum);
}

template <class T>
void TurnedCells<T>::give(lbm::Fluid<T>& fluid) {
  fluid.give_masses(takers_, taken_);
  takers_.clear(), taken_.clear();
  if (ranges_.empty()) return;
  for (const Range& range : ranges_)
    for (std::uint32_t n = range.first; n < range.first + range.count; ++n)
      fluid.hold_excess_around({range.block, fluid.blocks()[range.block].cell_at(cells_.host()[n].offset)});
  for (const lbm::LocalCell& cell : near_cells_) fluid.hold_excess_around(cell);
  const lbm::ListedCells<T> near =
      near_cells_.empty() ? lbm::ListedCells<T>{} : fluid.listed_again(listed_near_);
  for (const Range& range : ranges_) {
    PassingCells<T> cells = passing(fluid, range, nullptr);
    cells.near = near;
    SILT_ON(fluid.device(), share_masses<T>)(cells);
  }
  lbm::wait(fluid.device());
  ranges_.clear();
}

template class TurnedCells<float>;
template class TurnedCells<double>;

}  // namespace silt::coupler

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

/// Returns the moments of neighbours on other ranks, in the order of the uncovered cells.
template <class T>
std::vector<lbm::Moments> remote_moments(lbm::Fluid<T>& fluid, const std::vector<BlockMap>& maps,
                                         const ChangedCells& cells) {
  const lbm::Domain& domain = fluid.domain();
  if (domain.ranks() == 1) return {};
  const int here = parallel::rank_of(fluid.comm());
  SharedNeighbours<lbm::Moments> offers(domain), wants(domain);
  std::vector<lbm::LocalCell> offered;
  for (int b = 0; b < int(maps.size()); ++b) {
    const auto uncovered_bits = [&](int y, int z, int k) {
      return maps[b].before.at(y, z)[k] & ~maps[b].solid.at(y, z)[k];
    };
    for_ghosts(maps[b], uncovered_bits, [&](Int3 x) {
      const Int3 uncovered = maps[b].box.lower + x;
      const int rank = domain.rank_at(domain.wrapped(uncovered));
      for (int k = 1; rank != here && k < lbm::D3Q19::directions; ++k) {
        const Int3 y = x + lbm::D3Q19::c[k];
        if (!maps[b].has(y) || !maps[b].was_and_is_fluid(y)) continue;
        offers.add(rank, uncovered, k);
        offered.push_back({b, y});
      }
    });
  }
  for (const CoveredCell& u : cells.uncovered)
    for (int k = 1; k < lbm::D3Q19::directions; ++k) {
      const BlockMap& map = maps[u.block];
      const Int3 y = u.cell + lbm::D3Q19::c[k];
      if (map.has(y) || !map.was_and_is_fluid(y)) continue;
      const int rank = domain.rank_at(domain.wrapped(map.box.lower + y));
      if (rank != here) wants.add(rank, map.box.lower + u.cell, k);
    }
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
  add(changed.covered, +1), add(changed.uncovered, -1);
  cells_.send();
}

/// Lists neighbours of uncovered cells in other blocks, and has their moments computed or told.
template <class T>
void TurnedCells<T>::list_faces(lbm::Fluid<T>& fluid, const std::vector<BlockMap>& maps,
                                const ChangedCells& changed) {
  const std::vector<lbm::Moments> remote = remote_moments(fluid, maps, changed);
  told_.host().assign(remote.begin(), remote.end());
  const lbm::Domain& domain = fluid.domain();
  const int rank = parallel::rank_of(fluid.comm());
  faces_.host().clear(), places_.host().clear();
  std::vector<lbm::LocalCell> near;
  std::uint32_t told = 0;
  for (std::uint32_t n = 0; n < changed.uncovered.size(); ++n) {
    const std::uint32_t neighbours = cells_.host()[changed.covered.size() + n].neighbours;
    if (!(neighbours & ChangedCell::at_face)) continue;
    const CoveredCell& u = changed.uncovered[n];
    const BlockMap& map = maps[u.block];
    FaceCell face{n, 0, std::uint32_t(places_.size())};
    for (int k = 1; k < lbm::D3Q19::directions; ++k) {
      const Int3 y = u.cell + lbm::D3Q19::c[k];
      if (!(neighbours >> k & 1) || map.has(y)) continue;
      face.neighbours |= 1u << k;
      const Int3 g = domain.wrapped(map.box.lower + y);
      const lbm::BlockPlace there = domain.block_at(g);
      const int block = domain.local_index(there, rank);
      places_.host().push_back(block < 0 ? 2 * told++ : 2 * std::uint32_t(near.size()) + 1);
      if (block >= 0) near.push_back({block, g - there.box.lower});
    }
    faces_.host().push_back(face);
  }
  near_.host().resize(near.size());
  if (near.empty()) return;
  lbm::passes_on<T>(fluid.device())
      .gather_moments(fluid.listed(near, listed_near_), near_.make_room(), nullptr);
}

template <class T>
ChangedInBlock<T> TurnedCells<T>::in_block(lbm::Fluid<T>& fluid, const Range& range) {
  return {fluid.listed_block(range.block), cells_.device() + range.first, range.count};
}

template <class T>
PassingCells<T> TurnedCells<T>::passing(lbm::Fluid<T>& fluid, const Range& range) {
  return {in_block(fluid, range), range.sign, masses_.device() + range.first, left_.device()};
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
  const MomentsElsewhere elsewhere{faces_.send(), std::int64_t(faces_.size()), places_.send(), told_.send(),
                                   near_.device()};
  momenta_.send();
  const auto first_uncovered = std::uint32_t(changed.covered.size());
  const auto refill_block = SILT_ON(fluid.device(), refill_cells<T>);
  for (const Range& range : ranges_)
    if (range.sign < 0)
      refill_block(
          {in_block(fluid, range), range.first - first_uncovered, momenta_.device(), elsewhere, force});
  lbm::wait(fluid.device());
}

namespace {

/// Returns bits of cells that turned solid or fluid, with ghost cells.
auto changed_bits(const BlockMap& map) {
  return [&map](int y, int z, int k) { return map.before.at(y, z)[k] ^ map.solid.at(y, z)[k]; };
}

template <class T>
class PassOn {
 public:
  PassOn(lbm::Fluid<T>& fluid, const std::vector<BlockMap>& maps)
      : fluid_(fluid), maps_(maps), domain_(fluid.domain()), rank_(parallel::rank_of(fluid.comm())) {}

  /// Divides the mass of a cell evenly, but for the last quanta, among neighbours that were and are fluid.
  /// Returns the mass if there are none.
  std::int64_t share(const CoveredCell& c, std::int64_t mass) {
    const BlockMap& map = maps_[c.block];
    int neighbours[lbm::D3Q19::directions], count = 0;
    for (int k = 1; k < lbm::D3Q19::directions; ++k)
      if (map.was_and_is_fluid(c.cell + lbm::D3Q19::c[k])) neighbours[count++] = k;
    if (count == 0) return mass;
    for (int n = 0; n < count; ++n) {
      const std::int64_t part = mass / (count - n);
      mass -= part;
      give(c, neighbours[n], part);
    }
    return 0;
  }

  /// Receives the shares from cells of other ranks; returns all shares.
  MassShares finish() {
    if (domain_.ranks() > 1) take_from_others();
    return std::move(all_);
  }

 private:
  void give(const CoveredCell& c, int k, std::int64_t part) {
    const BlockMap& map = maps_[c.block];
    const Int3 y = c.cell + lbm::D3Q19::c[k];
    if (map.has(y)) return give({c.block, y}, part);
    const Int3 g = domain_.wrapped(map.box.lower + y);
    const lbm::BlockPlace there = domain_.block_at(g);
    const int block = domain_.local_index(there, rank_);
    if (block >= 0) return give({block, g - there.box.lower}, part);
    sent_.add(domain_.rank_at(g), map.box.lower + c.cell, k);
    parts_.push_back(double(part));
  }

  void give(const lbm::LocalCell& cell, std::int64_t mass) {
    all_.cells.push_back(cell), all_.masses.push_back(mass);
  }

  void take_from_others() {
    SharedNeighbours<double> wanted(domain_);
    for (int b = 0; b < int(maps_.size()); ++b) {
      const BlockMap& map = maps_[b];
      for_ghosts(map, changed_bits(map), [&](Int3 x) {
        const Int3 cell = map.box.lower + x;
        const int rank = domain_.rank_at(domain_.wrapped(cell));
        for (int k = 1; rank != rank_ && k < lbm::D3Q19::directions; ++k) {
          const Int3 y = x + lbm::D3Q19::c[k];
          if (!map.has(y) || !map.was_and_is_fluid(y)) continue;
          wanted.add(rank, cell, k);
          all_.cells.push_back({b, y});
        }
      });
    }
    const std::vector<double> found = sent_.exchange(fluid_.comm(), 8, parts_, wanted);
    for (const double mass : found) all_.masses.push_back(std::int64_t(mass));
  }

  lbm::Fluid<T>& fluid_;
  const std::vector<BlockMap>& maps_;
  const lbm::Domain& domain_;
  int rank_;
  MassShares all_;
  SharedNeighbours<double> sent_{domain_};
  std::vector<double> parts_;
};

}  // namespace

template <class T>
rigid::FixedSum TurnedCells<T>::weigh(lbm::Fluid<T>& fluid, const std::vector<BlockMap>& maps,
                                      const ChangedCells& changed) {
  PassOn<T> across(fluid, maps);
  std::int64_t left = 0;
  const auto share = [&](PassOn<T>& pass, const std::vector<CoveredCell>& cells, int sign,
                         std::size_t first) {
    std::vector<CoveredCell> at_faces;
    for (std::size_t n = 0; n < cells.size(); ++n)
      if (cells_.host()[first + n].neighbours & ChangedCell::at_face) at_faces.push_back(cells[n]);
    if (at_faces.empty()) return;
    const std::span<const double> densities = fluid.densities(places(at_faces));
    for (std::size_t n = 0; n < at_faces.size(); ++n)
      left += pass.share(at_faces[n], sign * std::llrint(densities[n] / lbm::excess_quantum<T>));
  };
  share(across, changed.covered, +1, 0), share(across, changed.uncovered, -1, changed.covered.size());
  others_ = across.finish();
  masses_.host().resize(cells_.size()), masses_.make_room();
  left_.host().assign(1, 0);
  if (!ranges_.empty()) {
    left_.clear();
    for (const Range& range : ranges_) SILT_ON(fluid.device(), weigh_cells<T>)(passing(fluid, range));
    left_.fetch(), lbm::wait(fluid.device());
  }
  return std::llrint(double(left + left_.host()[0]) * lbm::excess_quantum<T> / lbm::mass_quantum);
}

template <class T>
void TurnedCells<T>::give(lbm::Fluid<T>& fluid) {
  fluid.give_masses(others_.cells, others_.masses);
  others_ = {};
  if (ranges_.empty()) return;
  for (const Range& range : ranges_)
    for (std::uint32_t n = range.first; n < range.first + range.count; ++n)
      if (const auto& [offset, neighbours] = cells_.host()[n]; !(neighbours & ChangedCell::at_face))
        fluid.hold_excess_around({range.block, fluid.blocks()[range.block].cell_at(offset)});
  for (const Range& range : ranges_) SILT_ON(fluid.device(), share_masses<T>)(passing(fluid, range));
  lbm::wait(fluid.device());
  ranges_.clear();
}

template class TurnedCells<float>;
template class TurnedCells<double>;

}  // namespace silt::coupler

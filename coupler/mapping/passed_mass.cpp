#include "coupler/mapping/passed_mass.hpp"

#include <cmath>
#include <utility>

#include "coupler/mapping/shared_neighbours.hpp"
#include "parallel/communicator.hpp"

namespace silt::coupler {

using lbm::Int3;

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

/// Returns the neighbours of a cell that were and are fluid, as bits by direction, if all are in its block.
std::optional<std::uint32_t> neighbours_in_block(const BlockMap& map, Int3 cell) {
  std::uint32_t found = 0;
  for (int k = 1; k < lbm::D3Q19::directions; ++k) {
    const Int3 y = cell + lbm::D3Q19::c[k];
    if (!map.was_and_is_fluid(y)) continue;
    if (!map.has(y)) return std::nullopt;
    found |= 1u << k;
  }
  return found;
}

}  // namespace

template <class T>
rigid::FixedSum PassedMass<T>::weigh(lbm::Fluid<T>& fluid, const std::vector<BlockMap>& maps,
                                     const ChangedCells& changed) {
  inner_.clear(), neighbours_.host().clear(), left_.host().assign(1, 0);
  PassOn<T> pass(fluid, maps);
  std::int64_t left = 0;
  const auto share = [&](const std::vector<CoveredCell>& cells, int sign) {
    std::vector<CoveredCell> at_faces;
    for (const CoveredCell& cell : cells)
      if (const auto neighbours = neighbours_in_block(maps[cell.block], cell.cell))
        inner_.push_back({cell.block, cell.cell}), neighbours_.host().push_back(*neighbours);
      else
        at_faces.push_back(cell);
    if (at_faces.empty()) return;
    const std::span<const double> densities = fluid.densities(places(at_faces));
    for (std::size_t n = 0; n < at_faces.size(); ++n)
      left += pass.share(at_faces[n], sign * std::llrint(densities[n] / lbm::excess_quantum<T>));
  };
  share(changed.covered, +1);
  const auto covered = std::int64_t(inner_.size());
  share(changed.uncovered, -1);
  others_ = pass.finish();
  if (!inner_.empty()) {
    masses_.host().resize(inner_.size());
    passing_ = {fluid.listed(inner_, listed_), covered, neighbours_.send(), masses_.make_room(),
                left_.clear()};
    SILT_ON(fluid.device(), weigh_cells<T>)(passing_);
    left_.fetch(), lbm::wait(fluid.device());
  }
  return std::llrint(double(left + left_.host()[0]) * lbm::excess_quantum<T> / lbm::mass_quantum);
}

template <class T>
void PassedMass<T>::give(lbm::Fluid<T>& fluid) {
  fluid.give_masses(others_.cells, others_.masses);
  others_ = {};
  if (inner_.empty()) return;
  for (const lbm::LocalCell& cell : inner_) fluid.hold_excess_around(cell);
  fluid.list_blocks(listed_);  // the excess may be new
  SILT_ON(fluid.device(), share_masses<T>)(passing_);
  lbm::wait(fluid.device());
  inner_.clear();
}

template class PassedMass<float>;
template class PassedMass<double>;

}  // namespace silt::coupler

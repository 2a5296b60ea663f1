#include "coupler/mapping/changed_mass.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "coupler/mapping/shared_neighbours.hpp"
#include "parallel/communicator.hpp"

namespace silt::coupler {

using lbm::Int3;

namespace {

/// The cells of a block, ghosts too, that changed sides.
auto changed_bits(const BlockMap& map) {
  return [&map](int y, int z, int k) { return map.before.at(y, z)[k] ^ map.solid.at(y, z)[k]; };
}

template <class T>
class PassOn {
 public:
  PassOn(lbm::Fluid<T>& fluid, const std::vector<BlockMap>& maps)
      : fluid_(fluid), maps_(maps), domain_(fluid.domain()), rank_(parallel::rank_of(fluid.comm())) {}

  /// Shares the mass of a cell out to its neighbours that were fluid and still are, alike but for the last
  /// quanta. Returns what is left, if there are none.
  std::int64_t share(const CoveredCell& c, std::int64_t mass) {
    const BlockMap& map = maps_[c.block];
    int neighbours[lbm::directions], count = 0;
    for (int k = 1; k < lbm::directions; ++k)
      if (map.was_and_is_fluid(c.cell + lbm::c[k])) neighbours[count++] = k;
    if (count == 0) return mass;
    for (int n = 0; n < count; ++n) {
      const std::int64_t part = mass / (count - n);
      mass -= part;
      give(c, neighbours[n], part);
    }
    return 0;
  }

  /// Fetches what the cells of other ranks share out; returns it all.
  PassedMass finish() {
    if (domain_.ranks() > 1) take_from_others();
    return std::move(all_);
  }

 private:
  void give(const CoveredCell& c, int k, std::int64_t part) {
    const BlockMap& map = maps_[c.block];
    const Int3 y = c.cell + lbm::c[k];
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
        for (int k = 1; rank != rank_ && k < lbm::directions; ++k) {
          const Int3 y = x + lbm::c[k];
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
  PassedMass all_;
  SharedNeighbours<double> sent_{domain_};
  std::vector<double> parts_;
};

}  // namespace

template <class T>
PassedMass pass_on_mass(lbm::Fluid<T>& fluid, const std::vector<BlockMap>& maps,
                        const ChangedCells& changed) {
  constexpr double quantum = lbm::excess_quantum<T>;
  PassOn<T> pass(fluid, maps);
  std::int64_t left = 0;
  const auto share = [&](const std::vector<CoveredCell>& cells, int sign) {
    const std::span<const double> densities = fluid.densities(places(cells));
    for (std::size_t n = 0; n < cells.size(); ++n)
      left += pass.share(cells[n], sign * std::llrint(densities[n] / quantum));
  };
  share(changed.covered, +1);
  share(changed.uncovered, -1);
  PassedMass passed = pass.finish();
  passed.left = std::llrint(double(left) * quantum / lbm::mass_quantum);
  return passed;
}

template PassedMass pass_on_mass(lbm::Fluid<float>&, const std::vector<BlockMap>&, const ChangedCells&);
template PassedMass pass_on_mass(lbm::Fluid<double>&, const std::vector<BlockMap>&, const ChangedCells&);

}  // namespace silt::coupler

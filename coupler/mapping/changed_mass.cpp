#include "coupler/mapping/changed_mass.hpp"

#include <algorithm>
#include <cmath>

#include "coupler/mapping/shared_neighbours.hpp"
#include "parallel/communicator.hpp"

namespace silt::coupler {

using lbm::Int3;

namespace {

/// A cell of this rank's blocks, the place of its own populations, and what it gets.
struct Gain {
  int block;
  Int3 cell;
  std::int64_t quanta;
  auto place() const { return std::tie(block, cell.z, cell.y, cell.x); }
};

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

  /// Fetches what the cells of other ranks share out, and adds it all.
  void finish() {
    if (domain_.ranks() > 1) take_from_others();
    std::sort(gains_.begin(), gains_.end(),
              [](const Gain& a, const Gain& b) { return a.place() < b.place(); });
    std::vector<lbm::LocalCell> cells;
    std::vector<double> masses;
    for (auto g = gains_.begin(); g != gains_.end();) {
      const auto first = g;
      std::int64_t sum = 0;
      for (; g != gains_.end() && g->place() == first->place(); ++g) sum += g->quanta;
      cells.push_back({first->block, first->cell});
      masses.push_back(double(sum) * lbm::mass_quantum);
    }
    fluid_.add_masses(cells, masses);
  }

 private:
  void give(const CoveredCell& c, int k, std::int64_t part) {
    const BlockMap& map = maps_[c.block];
    const Int3 y = c.cell + lbm::c[k];
    if (map.has(y)) return gains_.push_back({c.block, y, part});
    const Int3 g = domain_.wrapped(map.box.lower + y);
    const lbm::BlockPlace there = domain_.block_at(g);
    const int block = domain_.local_index(there, rank_);
    if (block >= 0) return gains_.push_back({block, g - there.box.lower, part});
    sent_.add(domain_.rank_at(g), map.box.lower + c.cell, k);
    parts_.push_back(double(part));
  }

  void take_from_others() {
    SharedNeighbours<double> wanted(domain_);
    std::vector<Gain> gains;
    for (int b = 0; b < int(maps_.size()); ++b) {
      const BlockMap& map = maps_[b];
      const auto changed = [&](int y, int z, int k) {
        return map.before.at(y, z)[k] ^ map.solid.at(y, z)[k];
      };
      for_ghosts(map, changed, [&](Int3 x) {
        const Int3 cell = map.box.lower + x;
        const int rank = domain_.rank_at(domain_.wrapped(cell));
        for (int k = 1; rank != rank_ && k < lbm::directions; ++k) {
          const Int3 y = x + lbm::c[k];
          if (!map.has(y) || !map.was_and_is_fluid(y)) continue;
          wanted.add(rank, cell, k);
          gains.push_back({b, y, 0});
        }
      });
    }
    const std::vector<double> found = sent_.exchange(fluid_.comm(), 8, parts_, wanted);
    for (std::size_t n = 0; n < found.size(); ++n) gains[n].quanta = std::int64_t(found[n]);
    gains_.insert(gains_.end(), gains.begin(), gains.end());
  }

  lbm::Fluid<T>& fluid_;
  const std::vector<BlockMap>& maps_;
  const lbm::Domain& domain_;
  int rank_;
  std::vector<Gain> gains_;
  SharedNeighbours<double> sent_{domain_};
  std::vector<double> parts_;
};

}  // namespace

template <class T>
rigid::FixedSum pass_on_mass(lbm::Fluid<T>& fluid, const std::vector<BlockMap>& maps,
                             const ChangedCells& changed) {
  PassOn<T> pass(fluid, maps);
  rigid::FixedSum left = 0;
  const auto share = [&](const std::vector<CoveredCell>& cells, int sign) {
    const std::span<const double> densities = fluid.densities(places(cells));
    for (std::size_t n = 0; n < cells.size(); ++n)
      left += pass.share(cells[n], sign * std::llrint(densities[n] / lbm::mass_quantum));
  };
  share(changed.covered, +1);
  share(changed.uncovered, -1);
  pass.finish();
  return left;
}

template rigid::FixedSum pass_on_mass(lbm::Fluid<float>&, const std::vector<BlockMap>&, const ChangedCells&);
template rigid::FixedSum pass_on_mass(lbm::Fluid<double>&, const std::vector<BlockMap>&, const ChangedCells&);

}  // namespace silt::coupler

#include "coupler/mapping/refill.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <tuple>

#include "parallel/communicator.hpp"
#include "parallel/transfers.hpp"

namespace silt::coupler {

using lbm::Int3;

namespace {

/// The cells, ghosts too, whose bits are in `after` but not in `before`.
template <class F>
void for_new_bits(const CellBits& before, const CellBits& after, F&& f) {
  const Int3 size = after.size();
  for (int z = -1; z <= size.z; ++z)
    for (int y = -1; y <= size.y; ++y)
      for (int k = 0; k < after.words(); ++k) {
        const std::uint64_t fresh = after.at(y, z)[k] & ~before.at(y, z)[k];
        if (fresh) for_bits(fresh, k, [&](int x) { f(Int3{x, y, z}); });
      }
}

/// Calls f(cell) for every cell inside the block that a mask has and `other`, the block's solid cells or
/// those before, has not.
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

using MomentsKey = std::tuple<std::int64_t, int>;  // uncovered global cell, direction to the neighbour
using Packed = std::array<double, 10>;

Packed packed(const lbm::Moments& m) {
  return {m.density_deviation, m.momentum[0], m.momentum[1], m.momentum[2], m.flux[0],
          m.flux[1],           m.flux[2],     m.flux[3],     m.flux[4],     m.flux[5]};
}

/// Moments of neighbours that other ranks hold.
template <class T>
class RemoteMoments {
 public:
  RemoteMoments(const lbm::Fluid<T>& fluid, const std::vector<BlockMap>& maps, const ChangedCells& cells)
      : fluid_(fluid), domain_(fluid.domain()) {
    const int ranks = parallel::ranks_of(fluid.comm());
    if (ranks == 1) return;
    rank_ = parallel::rank_of(fluid.comm());
    std::map<int, std::map<MomentsKey, Packed>> outgoing;
    std::map<int, std::vector<MomentsKey>> wanted;
    for (int b = 0; b < int(maps.size()); ++b) offer(b, maps[b], outgoing);
    for (const auto& u : cells.uncovered) want(maps[u.block], u.cell, wanted);
    exchange(outgoing, wanted);
  }
  const Packed& at(std::int64_t cell, int k) const { return received_.at({cell, k}); }
  std::int64_t index(Int3 global) const {
    const Int3 g = domain_.wrapped(global), n = domain_.cells();
    return (std::int64_t(g.z) * n.y + g.y) * n.x + g.x;
  }

 private:
  void offer(int b, const BlockMap& map, std::map<int, std::map<MomentsKey, Packed>>& outgoing) const {
    if (!map.changed) return;
    const lbm::CellBox inside{{}, map.box.size};
    for_new_bits(map.solid, map.before, [&](Int3 x) {
      if (inside.contains(x)) return;
      const int rank = domain_.rank_at(domain_.wrapped(map.box.lower + x));
      if (rank == rank_) return;
      for (int k = 1; k < lbm::directions; ++k) {
        const Int3 y = x + lbm::c[k];
        if (inside.contains(y) && map.was_and_is_fluid(y))
          outgoing[rank][{index(map.box.lower + x), k}] = packed(fluid_.moments(b, y));
      }
    });
  }

  void want(const BlockMap& map, Int3 x, std::map<int, std::vector<MomentsKey>>& wanted) const {
    const lbm::CellBox inside{{}, map.box.size};
    for (int k = 1; k < lbm::directions; ++k) {
      const Int3 y = x + lbm::c[k];
      if (inside.contains(y) || !map.was_and_is_fluid(y)) continue;
      const int rank = domain_.rank_at(domain_.wrapped(map.box.lower + y));
      if (rank != rank_) wanted[rank].push_back({index(map.box.lower + x), k});
    }
  }

  void exchange(std::map<int, std::map<MomentsKey, Packed>>& outgoing,
                std::map<int, std::vector<MomentsKey>>& wanted) {
    parallel::Transfers transfers(fluid_.comm(), 2);
    std::map<int, std::vector<Packed>> in, out;
    for (auto& [rank, keys] : wanted) {
      std::sort(keys.begin(), keys.end());
      in[rank].resize(keys.size());
      transfers.receive(rank, std::span(in[rank]));
    }
    for (auto& [rank, values] : outgoing) {
      for (auto& [key, value] : values) out[rank].push_back(value);
      transfers.send(rank, std::span(out[rank]));
    }
    transfers.wait();
    for (auto& [rank, keys] : wanted)
      for (std::size_t n = 0; n < keys.size(); ++n) received_[keys[n]] = in[rank][n];
  }

  const lbm::Fluid<T>& fluid_;
  const lbm::Domain& domain_;
  int rank_ = 0;
  std::map<MomentsKey, Packed> received_;
};

struct Average {
  double density = 0, stress[6] = {};  // stress: mean of sum c c (g - g_eq)
  int count = 0;

  void add(const Packed& m, const std::array<double, 3>& force) {
    ++count;
    density += m[0];
    const double u[3] = {m[1] + 0.5 * force[0], m[2] + 0.5 * force[1], m[3] + 0.5 * force[2]};
    const double eq[6] = {m[0] / 3 + u[0] * u[0],
                          m[0] / 3 + u[1] * u[1],
                          m[0] / 3 + u[2] * u[2],
                          u[0] * u[1],
                          u[0] * u[2],
                          u[1] * u[2]};
    for (int k = 0; k < 6; ++k) stress[k] += m[4 + k] - eq[k];
  }
  void finish() {
    if (count == 0) return;
    density /= count;
    for (double& s : stress) s /= count;
  }
};

double grad_part(int i, const double s[6]) {
  const Int3 c = lbm::c[i];
  const double css = c.x * c.x * s[0] + c.y * c.y * s[1] + c.z * c.z * s[2] +
                     2 * (c.x * c.y * s[3] + c.x * c.z * s[4] + c.y * c.z * s[5]);
  return 4.5 * lbm::w(i) * (css - (s[0] + s[1] + s[2]) / 3);
}

/// The rows next to a cell's, for its neighbours' moments.
template <class T>
void prefetch_around(const lbm::Fluid<T>& fluid, const CoveredCell& u) {
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y) fluid.prefetch(u.block, u.cell + Int3{0, y, z});
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
    for (std::size_t k = 0; k < map.masks.size(); ++k) {
      const BodyMask& mask = map.masks[k];
      prefetch_bits(map.masks, k);
      if (mask.kept)
        kept[mask.before] = 1;
      else
        for_cells_lost(map, mask, map.before, [&](Int3 x) { cells.covered.push_back({b, x, &mask}); });
    }
    for (std::size_t k = 0; k < kept.size(); ++k) {
      const BodyMask& mask = map.masks_before[k];
      prefetch_bits(map.masks_before, k);
      if (!kept[k])
        for_cells_lost(map, mask, map.solid, [&](Int3 x) { cells.uncovered.push_back({b, x, &mask}); });
    }
  }
  return cells;
}

template <class T>
void refill(lbm::Fluid<T>& fluid, const std::vector<BlockMap>& maps, const ChangedCells& cells,
            const rigid::BodySet& bodies, const rigid::BodySet& gone, Refill scheme) {
  const RemoteMoments<T> remote(fluid, maps, cells);
  const auto& domain = fluid.domain();
  const auto& force = fluid.spec().force;
  const int rank = parallel::rank_of(fluid.comm());
  std::vector<Average> averages;
  averages.reserve(cells.uncovered.size());
  constexpr std::size_t ahead = 3;  // cells: far enough for memory to answer, few enough to stay in cache
  for (std::size_t n = 0; n < cells.uncovered.size(); ++n) {  // all averages before the first cell is written
    const CoveredCell& u = cells.uncovered[n];
    const BlockMap& map = maps[u.block];
    if (n + ahead < cells.uncovered.size()) prefetch_around(fluid, cells.uncovered[n + ahead]);
    const lbm::CellBox inside{{}, map.box.size};
    Average& mean = averages.emplace_back();
    for (int k = 1; k < lbm::directions; ++k) {
      const Int3 y = u.cell + lbm::c[k];
      if (!map.was_and_is_fluid(y)) continue;
      if (inside.contains(y)) {
        mean.add(packed(fluid.moments(u.block, y)), force);
        continue;
      }
      const Int3 g = domain.wrapped(map.box.lower + y);
      const lbm::BlockPlace there = domain.block_at(g);
      if (there.rank == rank)
        mean.add(packed(fluid.moments(there.index - domain.first_block(rank), g - there.box.lower)), force);
      else
        mean.add(remote.at(remote.index(map.box.lower + u.cell), k), force);
    }
    mean.finish();
  }
  for (std::size_t n = 0; n < cells.uncovered.size(); ++n) {
    const CoveredCell& u = cells.uncovered[n];
    const Average& mean = averages[n];
    double j[3] = {};
    for (const rigid::BodySet* set : {&bodies, &gone}) {
      const std::size_t row = u.body ? set->row_of(u.body->id) : set->size();
      if (row >= set->size()) continue;
      const Int3 cell = maps[u.block].box.lower + u.cell;
      const rigid::Vec3 v = set->velocity_at(row, nearest_arm(domain, set->position[row], cell));
      for (int d = 0; d < 3; ++d) j[d] = v[d] - 0.5 * force[d];
    }
    for (int i = 0; i < lbm::directions; ++i) {
      double g = lbm::equilibrium(i, mean.density, j);
      if (scheme == Refill::grad) g += grad_part(i, mean.stress);
      fluid.arriving(u.block, u.cell, i) = T(g);
    }
  }
}

template void refill(lbm::Fluid<float>&, const std::vector<BlockMap>&, const ChangedCells&,
                     const rigid::BodySet&, const rigid::BodySet&, Refill);
template void refill(lbm::Fluid<double>&, const std::vector<BlockMap>&, const ChangedCells&,
                     const rigid::BodySet&, const rigid::BodySet&, Refill);

}  // namespace silt::coupler

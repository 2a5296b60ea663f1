#include "coupler/flow_totals.hpp"

#include <algorithm>
#include <cmath>

#include "coupler/exchange/reduce.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "lbm/cut_links.hpp"
#include "lbm/fluid.hpp"

namespace silt::coupler {

using lbm::Int3;

void FlowSums::add(Int3 g, const lbm::Moments& m, const std::array<double, 3>& u) {
  constexpr double no_flow_is_so_fast = 1e3;
  const std::int64_t index = (std::int64_t(g.z) * cells_.y + g.y) * cells_.x + g.x;
  const double speed = std::sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
  if (!std::isfinite(m.density_deviation) || !(speed < no_flow_is_so_fast)) {
    first_bad_ = std::min(first_bad_, index);
    return;
  }
  ++count_;
  sums_[0] += std::llrint(m.density_deviation / lbm::mass_quantum);
  for (int d = 0; d < 3; ++d) sums_[1 + d] += std::llrint(m.momentum[d] / lbm::mass_quantum);
  speed_.see(speed, index);
  deficit_.see(-m.density_deviation, index);
  max_excess_ = std::max(max_excess_, m.density_deviation);
}

FlowTotals FlowSums::over_ranks(MPI_Comm comm) const {
  std::uint64_t count = count_;
  rigid::FixedSum sums[4] = {sums_[0], sums_[1], sums_[2], sums_[3]};
  Extreme speed = speed_, deficit = deficit_;
  sum_over_ranks(comm, std::span(&count, 1));
  sum_over_ranks(comm, sums);
  speed.over_ranks(comm);
  deficit.over_ranks(comm);
  const auto bad = std::int64_t(least_over_ranks(comm, std::uint64_t(first_bad_)));
  FlowTotals t;
  t.fluid_cells = count;
  t.mass_deviation = double(sums[0]) * lbm::mass_quantum;
  for (int d = 0; d < 3; ++d) t.momentum[d] = double(sums[1 + d]) * lbm::mass_quantum;
  t.max_speed = std::max(speed.value, 0.0), t.min_density = 1 - deficit.value;
  t.max_density = 1 + max_over_ranks(comm, max_excess_);
  t.finite = bad == none;
  t.bad_cell = cell_at(bad), t.fastest_cell = cell_at(speed.cell), t.thinnest_cell = cell_at(deficit.cell);
  return t;
}

void FlowSums::Extreme::over_ranks(MPI_Comm comm) {
  const double largest = max_over_ranks(comm, value);
  cell = std::int64_t(least_over_ranks(comm, std::uint64_t(value == largest ? cell : none)));
  value = largest;
}

lbm::Int3 FlowSums::cell_at(std::int64_t index) const {
  if (index == none) return {};
  return {int(index % cells_.x), int(index / cells_.x % cells_.y), int(index / cells_.x / cells_.y)};
}

template <class T>
FlowSums flow_sums(const lbm::Fluid<T>& fluid, std::span<const BlockMap> maps) {
  FlowSums sums(fluid.domain().cells());
  for (std::size_t b = 0; b < maps.size(); ++b) {
    lbm::MomentsByRow moments(fluid, int(b), 0, maps[b].box.size.x);
    for_fluid_cells(maps.subspan(b, 1), [&](int, Int3 x) {
      const lbm::Moments m = moments(x);
      sums.add(maps[b].box.lower + x, m, fluid.velocity(m));
    });
  }
  return sums;
}

template <class T>
FlowTotals flow_totals(const lbm::Fluid<T>& fluid, std::span<const BlockMap> maps) {
  return flow_sums(fluid, maps).over_ranks(fluid.comm());
}

template FlowSums flow_sums(const lbm::Fluid<float>&, std::span<const BlockMap>);
template FlowSums flow_sums(const lbm::Fluid<double>&, std::span<const BlockMap>);

template FlowTotals flow_totals(const lbm::Fluid<float>&, std::span<const BlockMap>);
template FlowTotals flow_totals(const lbm::Fluid<double>&, std::span<const BlockMap>);

}  // namespace silt::coupler

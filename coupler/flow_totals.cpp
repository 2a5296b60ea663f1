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
  const double speed = std::sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
  if (!std::isfinite(m.density_deviation) || !(speed < no_flow_is_so_fast)) {
    first_bad_ = std::min(first_bad_, (std::int64_t(g.z) * cells_.y + g.y) * cells_.x + g.x);
    return;
  }
  ++count_;
  sums_[0] += std::llrint(m.density_deviation / lbm::mass_quantum);
  for (int d = 0; d < 3; ++d) sums_[1 + d] += std::llrint(m.momentum[d] / lbm::mass_quantum);
  max_speed_ = std::max(max_speed_, speed);
  max_deficit_ = std::max(max_deficit_, -m.density_deviation);
  max_excess_ = std::max(max_excess_, m.density_deviation);
}

FlowTotals FlowSums::over_ranks(MPI_Comm comm) const {
  std::uint64_t count = count_;
  rigid::FixedSum sums[4] = {sums_[0], sums_[1], sums_[2], sums_[3]};
  double most[3] = {max_speed_, max_deficit_, max_excess_};
  std::int64_t bad = first_bad_;
  sum_over_ranks(comm, std::span(&count, 1));
  sum_over_ranks(comm, sums);
  max_over_ranks(comm, most);
  MPI_Allreduce(MPI_IN_PLACE, &bad, 1, MPI_INT64_T, MPI_MIN, comm);
  FlowTotals t;
  t.fluid_cells = count;
  t.mass_deviation = double(sums[0]) * lbm::mass_quantum;
  for (int d = 0; d < 3; ++d) t.momentum[d] = double(sums[1 + d]) * lbm::mass_quantum;
  t.max_speed = most[0], t.min_density = 1 - most[1], t.max_density = 1 + most[2];
  t.finite = bad == none;
  if (!t.finite)
    t.bad_cell = {int(bad % cells_.x), int(bad / cells_.x % cells_.y), int(bad / cells_.x / cells_.y)};
  return t;
}

template <class T>
FlowSums flow_sums(const lbm::Fluid<T>& fluid, std::span<const BlockMap> maps) {
  FlowSums sums(fluid.domain().cells());
  for_fluid_cells(maps, [&](int b, Int3 x) {
    const lbm::Moments m = fluid.moments(b, x);
    sums.add(maps[b].box.lower + x, m, fluid.velocity(m));
  });
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

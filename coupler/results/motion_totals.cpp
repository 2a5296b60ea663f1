#include "coupler/results/motion_totals.hpp"

#include "parallel/collectives.hpp"
#include "rigid/math/exact_sum.hpp"

namespace silt::coupler {

using rigid::Vec3;

MotionTotals motion_totals(const Simulation& simulation) {
  const Scene& scene = simulation.scene();
  const rigid::BodySet& rows = scene.bodies;
  rigid::ExactSum sums[4];  // momentum, kinetic energy
  for (std::size_t row = 0; row < rows.owned; ++row) {
    if (!rows.is_dynamic(row)) continue;
    for (int d = 0; d < 3; ++d) sums[d].add(rows.mass[row] * rows.velocity[row][d]);
    sums[3].add(rows.kinetic_energy(row));
  }
  parallel::sum_over_ranks(scene.comm, std::span(sums));
  MotionTotals totals;
  for (int d = 0; d < 3; ++d) totals.bodies_momentum[d] = sums[d].value();
  totals.bodies_energy = sums[3].value();
  if (!scene.flow) return totals;
  const FlowTotals flow = scene.flow->account().totals();
  totals.fluid_momentum = scene.flow->fields().velocity_sum(flow);
  totals.fluid_energy = flow.energy;
  return totals;
}

}  // namespace silt::coupler

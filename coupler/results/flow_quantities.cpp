#include "coupler/results/flow_quantities.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "coupler/analytic_flow.hpp"
#include "coupler/case/case.hpp"
#include "coupler/placement/body_records.hpp"
#include "coupler/results/body_quantities.hpp"
#include "coupler/results/strain_rate.hpp"
#include "parallel/collectives.hpp"
#include "rigid/math/elementary.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

namespace {

using rigid::FixedSum;
using rigid::from_fixed;
using rigid::to_fixed;

/// Mean along an axis over all cells of the domain of the velocity less `frame`, solid ones counting as zero.
double superficial_velocity(const Simulation& simulation, int axis, double frame) {
  const Flow& flow = *simulation.scene().flow;
  const FlowTotals totals = flow.account().totals();
  const auto& n = simulation.setup().cells;
  return (flow.fields().velocity_sum(totals)[axis] - static_cast<double>(totals.fluid_cells) * frame) /
         (double(n[0]) * n[1] * n[2]);
}

struct VortexSums {
  double error2 = 0, exact2 = 0;           // of |u - exact|^2, |exact|^2
  double projection = 0, projection0 = 0;  // of u . exact(0), |exact(0)|^2
};

VortexSums vortex_sums(const Simulation& simulation, const TaylorGreen& exact) {
  const FluidFields& fields = simulation.scene().flow->fields();
  const double t = static_cast<double>(simulation.steps_done());
  FixedSum sums[4] = {};
  for_each_fluid_cell(fields, [&](lbm::Int3 x, const lbm::Moments& m) {
    const auto u = fields.velocity(m);
    const auto now = exact.velocity(x.x + 0.5, x.y + 0.5, t), begin = exact.velocity(x.x + 0.5, x.y + 0.5, 0);
    double terms[4] = {};
    for (int d = 0; d < 3; ++d) {
      terms[0] += (u[d] - now[d]) * (u[d] - now[d]);
      terms[1] += now[d] * now[d];
      terms[2] += u[d] * begin[d];
      terms[3] += begin[d] * begin[d];
    }
    for (int k = 0; k < 4; ++k) sums[k] += to_fixed(terms[k]);
  });
  parallel::sum_over_ranks(simulation.scene().comm, sums);
  return {from_fixed(sums[0]), from_fixed(sums[1]), from_fixed(sums[2]), from_fixed(sums[3])};
}

}  // namespace

/// F / (6 pi mu a U) a body: F the fluid's force on it and the body force on the fluid it displaces (together
/// the whole pressure gradient's work, as in Zick and Homsy 1982), U the superficial velocity, a its radius.
double drag_coefficient(const Simulation& simulation, const QuantitySpec& q) {
  const Case& scene = simulation.setup();
  const rigid::BodySet& bodies = simulation.bodies();
  const auto shapes = centred_shapes(scene);
  const auto loads = simulation.last_loads();
  struct {
    FixedSum force = 0, radius = 0, count = 0;
  } mine;
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    if (!q.is_about(bodies.kind[row]) || bodies.motion[row] != rigid::Motion::fixed) continue;
    const double volume = shapes[bodies.shape[row]].volume;
    mine.force += to_fixed(loads[row].force[q.axis] + scene.fluid->body_force[q.axis] * volume);
    mine.radius += to_fixed(rigid::elementary::cbrt(volume * 0.75 / std::numbers::pi));
    mine.count += to_fixed(1);
  }
  const auto all = parallel::sum_over_ranks(simulation.scene().comm, mine);
  const double speed = superficial_velocity(simulation, q.axis, 0),
               viscosity = scene.fluid->kinematic_viscosity;
  if (all.count == 0 || simulation.steps_done() == 0 || speed == 0) return no_value;
  const double count = from_fixed(all.count), force = from_fixed(all.force) / count,
               radius = from_fixed(all.radius) / count;
  return force / (6 * std::numbers::pi * viscosity * radius * speed);
}

double kinetic_energy(const Simulation& simulation) {
  const FlowTotals totals = simulation.scene().flow->account().totals();
  return totals.fluid_cells > 0 ? totals.energy / static_cast<double>(totals.fluid_cells) : no_value;
}

double dissipation(const Simulation& simulation) {
  const FluidFields& fields = simulation.scene().flow->fields();
  const FluidSpec& fluid = *simulation.setup().fluid;
  struct {
    FixedSum squares = 0, cells = 0;
  } mine;
  for_each_fluid_cell(fields, [&](lbm::Int3, const lbm::Moments& m) {
    mine.squares += to_fixed(strain_rate_squared(fields, m, fluid));
    mine.cells += to_fixed(1);
  });
  const auto all = parallel::sum_over_ranks(simulation.scene().comm, mine);
  return all.cells > 0 ? 2 * fluid.kinematic_viscosity * from_fixed(all.squares) / from_fixed(all.cells)
                       : no_value;
}

double superficial_velocity(const Simulation& simulation, const QuantitySpec& q) {
  const double bodies = simulation.body_count() > 0 ? mean_velocity(simulation, q) : 0;
  return superficial_velocity(simulation, q.axis, bodies);
}

double profile_error(const Simulation& simulation, const QuantitySpec& q) {
  const FluidFields& fields = simulation.scene().flow->fields();
  const auto exact = exact_profile(simulation.setup(), q.profile);
  double error = 0;
  for_each_fluid_cell(fields, [&](lbm::Int3 x, const lbm::Moments& m) {
    const auto u = fields.velocity(m);
    const double e =
        (rigid::Vec3(u[0], u[1], u[2]) - exact.velocity({x.x + 0.5, x.y + 0.5, x.z + 0.5})).norm();
    if (!(e <= error)) error = e;  // a NaN stays
  });
  return parallel::max_over_ranks(simulation.scene().comm, error) / exact.largest;
}

double vortex_velocity_error(const Simulation& simulation) {
  const VortexSums sums = vortex_sums(simulation, TaylorGreen(simulation.setup()));
  return std::sqrt(sums.error2 / sums.exact2);
}

double vortex_decay_error(const Simulation& simulation) {
  if (simulation.steps_done() == 0) return no_value;
  const TaylorGreen exact(simulation.setup());
  const VortexSums sums = vortex_sums(simulation, exact);
  const double rate = -rigid::elementary::log(sums.projection / sums.projection0) /
                      static_cast<double>(simulation.steps_done());
  return rate / exact.decay_rate() - 1;
}

}  // namespace silt::coupler

#include "coupler/results/motion_totals.hpp"

#include "coupler/exchange/reduce.hpp"
#include "coupler/for_each_cell.hpp"

namespace silt::coupler {

using rigid::ExactSum;
using rigid::Vec3;

namespace {

struct Sums {
  ExactSum terms[4];  // momentum, kinetic energy
  void add(double mass, const Vec3& velocity, double energy) {
    for (int d = 0; d < 3; ++d) terms[d].add(mass * velocity[d]);
    terms[3].add(energy);
  }
  void over_ranks(MPI_Comm comm, Vec3& momentum, double& energy) {
    sum_over_ranks(comm, terms);
    for (int d = 0; d < 3; ++d) momentum[d] = terms[d].value();
    energy = terms[3].value();
  }
};

}  // namespace

MotionTotals motion_totals(const Simulation& simulation) {
  const Scene& scene = simulation.scene();
  const rigid::BodySet& rows = scene.bodies;
  MotionTotals totals;
  Sums bodies, fluid;
  for (std::size_t row = 0; row < rows.owned; ++row)
    if (rows.is_dynamic(row)) bodies.add(rows.mass[row], rows.velocity[row], rows.kinetic_energy(row));
  bodies.over_ranks(scene.comm, totals.bodies_momentum, totals.bodies_energy);
  if (!scene.flow) return totals;
  const Flow& flow = *scene.flow;
  for_each_fluid_cell(flow, [&](lbm::Int3, const lbm::Moments& m) {
    const auto u = flow.velocity(m);
    const Vec3 velocity(u[0], u[1], u[2]);
    fluid.add(1, velocity, 0.5 * velocity.squaredNorm());
  });
  fluid.over_ranks(scene.comm, totals.fluid_momentum, totals.fluid_energy);
  return totals;
}

}  // namespace silt::coupler

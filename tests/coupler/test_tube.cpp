// Flows in a tube whose exact solutions are known, and balances of momentum.
#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>
#include <numbers>

#include "coupler/case/case.hpp"
#include "coupler/case/quantity_spec.hpp"
#include "coupler/simulation.hpp"
#include "lbm/cut_links.hpp"
#include "tests/coupler/case/pipe_case.hpp"
#include "tests/coupler/single_cells.hpp"

namespace silt::coupler::testing {
namespace {

using std::numbers::pi;

/// Until the flow is steady: exp(-5.78 nu t / R^2) is below 1e-7.
int long_enough(double radius) {
  return int(radius * radius / 0.1 * 3);
}

/// Along the body force in the tube of a case g (R^2 - r^2) / (4 nu) along the axis, and its rigid motion.
rigid::Vec3 exact_velocity(const Case& setup, const rigid::Vec3& x) {
  const rigid::HollowWallSpec& wall = *setup.walls[0].hollow();
  const double radius = std::get<rigid::Tube>(wall.shape).radius;
  const rigid::Vec3 from = x - wall.point, arm = from - wall.axis.dot(from) * wall.axis;
  const double flow = setup.fluid->body_force.dot(wall.axis) * (radius * radius - arm.squaredNorm()) /
                      (4 * setup.fluid->kinematic_viscosity);
  return (flow + wall.velocity) * wall.axis + wall.angular_velocity * wall.axis.cross(arm);
}

/// Relative L2 error against the exact flow of the mean velocity over two steps. (A sudden start leaves a
/// staggered momentum, u_y ~ (-1)^(y + t), that no collision damps; it changes its sign from step to step.)
double error_of(Simulation& simulation) {
  const FluidFields& fields = simulation.scene().flow->fields();
  std::vector<rigid::Vec3> before;
  for_each_cell(fields,
                [&](int b, lbm::Int3 cell, lbm::Int3) { before.push_back(velocity(fields, b, cell)); });
  simulation.step();
  double sums[2] = {};
  auto then = before.begin();
  for_each_cell(fields, [&](int b, lbm::Int3 cell, lbm::Int3 g) {
    const rigid::Vec3 mean = 0.5 * (*then++ + velocity(fields, b, cell));
    if (!fields.is_fluid(b, cell)) return;
    const rigid::Vec3 v = exact_velocity(simulation.setup(), {g.x + 0.5, g.y + 0.5, g.z + 0.5});
    sums[0] += (mean - v).squaredNorm(), sums[1] += v.squaredNorm();
  });
  return std::sqrt(sums[0] / sums[1]);
}

/// Order of convergence between radii: the slope of the regression of log error on log radius.
double order(const std::vector<double>& radii, const std::vector<double>& errors) {
  double x = 0, y = 0, xx = 0, xy = 0;
  const double n = double(radii.size());
  for (std::size_t k = 0; k < radii.size(); ++k) {
    const double a = std::log(radii[k]), b = std::log(errors[k]);
    x += a, y += b, xx += a * a, xy += a * b;
  }
  return -(n * xy - x * y) / (n * xx - x * x);
}

/// Of the fluid on the tube, on one rank.
BodyLoad load_of_fluid(const Simulation& simulation) {
  const auto share = simulation.scene().flow->account().wall_load(0);
  BodyLoad load;
  for (int d = 0; d < 3; ++d) {
    load.force[d] = lbm::link_quantum * double(share[d]);
    load.torque[d] = lbm::link_quantum * double(share[3 + d]);
  }
  return load;
}

constexpr double radii[] = {5.3, 7.45, 10.6, 14.9};

TEST(Tube, ItsPointMayBeFarAlongItsAxis) {
  const CaseText text = pipe(7.45, "angular_velocity = 0.002", 1e-5, 1);
  Simulation near = text.start(MPI_COMM_SELF),
             far = text.start(MPI_COMM_SELF, {"walls[0].point=[-1e8, 9.13, 8.71]"});
  near.run(20), far.run(20);
  EXPECT_EQ(near.hash(), far.hash());
}

TEST(Tube, PoiseuilleIsOfSecondOrder) {
  std::vector<double> errors;
  for (const double radius : radii) {
    const double force = 0.05 * 4 * 0.1 / (radius * radius);
    Simulation simulation = pipe(radius, "", force, 1).start(MPI_COMM_SELF);
    simulation.run(long_enough(radius));
    errors.push_back(error_of(simulation));
    // what drives the fluid ends up on the wall
    const FlowTotals totals = simulation.look_at_flow();
    EXPECT_NEAR(load_of_fluid(simulation).force[0], force * double(totals.fluid_cells),
                1e-5 * force * double(totals.fluid_cells));
    EXPECT_NEAR(totals.mass_deviation, 0, 1e-8 * double(totals.fluid_cells));
    // second order, small: only rows of one and two cells between the walls do not have the parabola
    EXPECT_LT(errors.back(), 0.04 / (radius * radius)) << radius;
  }
  EXPECT_GT(order({std::begin(radii), std::end(radii)}, errors), 1.7)
      << errors[0] << ' ' << errors[1] << ' ' << errors[2] << ' ' << errors[3];
}

/// The fluid in a tube that turns and slides comes to move with it as if it were rigid: without shear the
/// links are exact, wherever they cut. Then nothing acts on the wall.
TEST(Tube, FluidMovesRigidlyWithTheTube) {
  for (const double radius : radii) {
    const std::string motion = fmt::format("angular_velocity = {}\nvelocity = 0.01", 0.02 / radius);
    Simulation simulation = pipe(radius, motion, 0, 1).start(MPI_COMM_SELF);
    simulation.run(long_enough(radius));
    const BodyLoad one = load_of_fluid(simulation);
    EXPECT_LT(error_of(simulation), 1e-3) << radius;
    const BodyLoad next = load_of_fluid(simulation);
    const double scale = 4 * pi * 0.1 * 0.02 * radius * 4;  // of the torque while it spins up
    EXPECT_LT(0.5 * std::abs(one.torque[0] + next.torque[0]), 2e-3 * scale) << radius;
    EXPECT_LT(0.5 * std::abs(one.force[0] + next.force[0]), 1e-6) << radius;
  }
}

/// The torque that spins the fluid up is what its angular momentum gains.
TEST(Tube, TorqueIsTheGainOfAngularMomentum) {
  const double radius = 10.6, omega = 0.02 / radius;
  Simulation simulation =
      pipe(radius, fmt::format("angular_velocity = {}", omega), 0, 1).start(MPI_COMM_SELF);
  double given = 0;
  for (int i = 0; i < long_enough(radius); ++i) {
    simulation.step();
    given -= load_of_fluid(simulation).torque[0];
  }
  const double gained = 0.5 * pi * std::pow(radius, 4) * 4 * omega;
  EXPECT_NEAR(given, gained, 0.02 * gained);
}

}  // namespace
}  // namespace silt::coupler::testing

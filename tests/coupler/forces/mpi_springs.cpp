// Springs, dampers and hinges against closed forms; and the same bits on any number of ranks.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>
#include <numbers>

#include "coupler/case/case.hpp"
#include "coupler/results/quantities.hpp"
#include "tests/coupler/case/case_text.hpp"
#include "tests/coupler/same_bits.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Vec3;

const double ball_volume = 4 * std::numbers::pi / 3 * 64;  // of a ball of radius 4

CaseText dry(const std::string& bodies, const std::string& springs) {
  CaseText c;
  c.fluid = "";
  c.domain = domain_of({64, 64, 64});
  c.bodies = bodies;
  c.rest = springs;
  return c;
}

/// m x'' + c x' + k x = 0 from rest at 3: x = 3 exp(-g t) (cos w t + g / w sin w t).
TEST(Springs, AMassOnADampedSpringSwingsAndDecaysAsTheorySays) {
  const double mass = 1.2 * ball_volume, k = 1e-3 * mass, damping = 4e-3 * mass;
  const CaseText c =
      dry(body_of("ball", 1.2, "position = [35, 32, 32]"),
          fmt::format("[[springs]]\nbody = \"ball\"\nends = [[35, 32, 32], [12, 32, 32]]\nlength = 20\n"
                      "stiffness = {}\ndamping = {}\n",
                      k, damping));
  tests::alone([&] {
    Simulation simulation = c.start(MPI_COMM_SELF);
    const double g = damping / mass / 2, w = std::sqrt(k / mass - g * g);
    for (int n = 0; n < 20; ++n) {
      simulation.run(50);
      const double t = double(simulation.steps_done());
      const double x = 3 * std::exp(-g * t) * (std::cos(w * t) + g / w * std::sin(w * t));
      EXPECT_NEAR(simulation.bodies().position[0][0], 32 + x, 3 * 8e-3)
          << t << ": of the first order in damping over mass, 4e-3";
    }
    EXPECT_EQ(simulation.bodies().position[0][1], 32);
    return 0;
  });
}

/// Two balls apart from each other on any ranks: about their common centre, at the frequency of their reduced
/// mass, through a periodic side.
CaseText two_balls(double k) {
  return dry(body_of("ball", 1.2, "name = \"a\"\nposition = [60, 30, 32]") +
                 body_of("ball", 2.4, "name = \"b\"\nposition = [10, 34, 32]"),
             fmt::format("[[springs]]\nbody = \"a\"\nto = \"b\"\nlength = 12\nstiffness = {}\n", k));
}

TEST(Springs, TwoBodiesSwingAboutTheirCentre) {
  const double reduced = 0.8 * ball_volume, k = 4e-4 * reduced, distance = std::hypot(14, 4);
  Simulation simulation = two_balls(k).start(MPI_COMM_WORLD);
  const double w = std::sqrt(k / reduced);
  const int steps = int(std::lround(7.5 * 2 * std::numbers::pi / w));
  const auto place = [&](int id) {
    const std::size_t row = simulation.bodies().row_of(rigid::BodyId(id));
    const bool own = row < simulation.bodies().owned;
    Vec3 x;
    for (int d = 0; d < 3; ++d)
      x[d] = tests::sum_over_ranks(
          own ? simulation.bodies().position[row][d] + 64 * simulation.bodies().image[row][d] : 0);
    return x;
  };
  simulation.run(steps);
  const Vec3 a = place(1), b = place(2);
  EXPECT_NEAR((b - a + Vec3(64, 0, 0)).norm(), 12 + (distance - 12) * std::cos(w * steps),
              2e-3 * (distance - 12));
  EXPECT_LT((a + 2 * b - Vec3(60 + 20, 30 + 68, 96)).norm(), 1e-9) << "the centre of mass";
}

TEST(Springs, SameBitsOnAnyRanksAndInARunThatGoesOn) {
  CaseText c = two_balls(0.1);
  c.fluid = "[fluid]\nrelaxation_time = 0.8\n";
  c.rest +=
      "[[springs]]\nbody = \"a\"\nends = [[61, 30, 33], [50, 30, 30]]\nlength = 0\nstiffness = 0.2\ndamping "
      "= 1\n";
  expect_one_hash(c, 60, {"[16, 64, 32]"});
  Simulation simulation = c.start(MPI_COMM_WORLD);
  simulation.run(23);
  expect_goes_on(simulation, 37);
}

/// A rod of length 16 that hangs from an axis through its end, held there by two springs without a length:
/// w^2 = m g s / (I + m s^2) for small angles.
TEST(Springs, TwoOfNoLengthAreAHinge) {
  constexpr double arm = 8, start = 0.05, gravity = 2e-5;
  const double mass = 2 * 16 * 4 * 4, moment = mass * (16 * 16 + 4 * 4) / 12.;
  const Vec3 hinge(32, 32, 40);
  const Vec3 centre = hinge + arm * Vec3(std::sin(start), 0, -std::cos(start));
  std::string springs = fmt::format("[gravity]\nacceleration = [0, 0, -{}]\n", gravity);
  for (const double y : {30., 34.})
    springs += fmt::format(
        "[[springs]]\nbody = \"rod\"\nends = [[32, {}, 40], [32, {}, 40]]\nlength = 0\nstiffness = {}\n", y,
        y, 0.02 * mass);
  CaseText c =
      dry(body_of("rod", 2,
                  fmt::format("position = [{}, {}, {}]\naxis_angle = {{ axis = [0, 1, 0], degrees = {} }}",
                              centre[0], centre[1], centre[2], -start * 180 / std::numbers::pi)),
          springs);
  c.shapes = shape_of("rod", "box", "edges = [4, 4, 16]");
  tests::alone([&] {
    Simulation simulation = c.start(MPI_COMM_SELF);
    const double w = std::sqrt(mass * gravity * arm / (moment + mass * arm * arm));
    const double period = 2 * std::numbers::pi / w * (1 + start * start / 16);
    double largest = 0, crossed = 0, before = 0;
    int crossings = 0;
    for (int i = 0; i < int(2.6 * period); ++i) {
      simulation.step();
      const rigid::Pose pose = simulation.bodies().pose(0);
      largest = std::max(largest, (pose.to_world({0, 0, arm}) - hinge).norm());
      const double x = pose.position[0] - 32;
      if (i > 0 && before * x < 0) crossed = i + before / (before - x), ++crossings;
      before = x;
    }
    EXPECT_EQ(crossings, 5);
    EXPECT_NEAR(crossed, 2.25 * period, 5e-3 * period);
    EXPECT_LT(largest, 5e-3) << "g over the square of its frequency, 0.14 a step";
    EXPECT_LT(simulation.bodies().angular_velocity[0].cross(Vec3::UnitY()).norm(), 1e-9)
        << "about the axis alone";
    return 0;
  });
}

/// The force of the fluid on a ball that a spring holds is told without the spring.
TEST(Springs, AreNoForceOfTheFluid) {
  CaseText c;
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nbody_force = [1e-5, 0, 0]\n";
  c.rest =
      "[[springs]]\nbody = \"ball\"\nends = [[16, 16, 16], [16, 16, 16]]\nstiffness = 10\ndamping = 30\n";
  c.run =
      "[run]\nsteps = 4000\n[[quantities]]\nname = \"f\"\ntype = \"fluid-force\"\naxis = \"x\"\n"
      "[[quantities]]\nname = \"x\"\ntype = \"displacement\"\naxis = \"x\"\n";
  const auto values = c.values(MPI_COMM_WORLD);
  EXPECT_GT(values[0], 0.01);
  EXPECT_NEAR(values[0], 10 * values[1], 1e-3 * values[0]) << "the spring holds it against the fluid";
}

}  // namespace
}  // namespace silt::coupler::testing

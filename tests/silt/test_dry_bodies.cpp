// Bodies without a fluid at the edge of what resolvers and time steps can do:
// sffd holds towers, heavy on light, and a gas without loss; what a resolver or
// a time step is not up to is stopped with a cure that works.
#include <gtest/gtest.h>

#include <algorithm>

#include "silt/case/case.hpp"
#include "silt/guard.hpp"
#include "silt/simulation.hpp"
#include "tests/errors.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/silt/gas.hpp"

namespace silt::testing {
namespace {

using rigid::Vec3;

constexpr double cube_edge = 2;
/// Boxes of an edge of 2 in the field of the earth, steps of a millisecond, cells of 0.1 m; the last one is
/// `ratio` times as heavy as the others.
CaseText boxes_at(const std::vector<Vec3>& positions, const std::array<int, 3>& cells, double ratio = 1) {
  CaseText c;
  c.domain = domain_of(cells, "{ x = \"periodic\", y = \"periodic\", z = [\"no-slip\", \"no-slip\"] }");
  c.fluid.clear();
  c.rest = "[gravity]\nacceleration = [0, 0, -9.81e-5]\n[contacts]\nfriction = 0.5\nmargin = 0.2\n";
  c.shapes = shape_of("box", "box", "edges = [2, 2, 2]");
  c.bodies.clear();
  for (const Vec3& x : positions)
    c.bodies += body_of("box", &x == &positions.back() ? ratio : 1,
                        "position = [" + std::to_string(x[0]) + ", " + std::to_string(x[1]) + ", " +
                            std::to_string(x[2]) + "]");
  return c;
}

/// One box on the other, the k-th above the lowest at offsets[k] along x; the topmost `ratio` times as heavy.
CaseText stack(const std::vector<double>& offsets, double ratio = 1) {
  const int n = static_cast<int>(offsets.size());
  std::vector<Vec3> positions;
  for (int k = 0; k < n; ++k) positions.emplace_back(10 + offsets[k], 10, (k + 0.5) * cube_edge);
  return boxes_at(positions, {40, 20, 2 * n + 10}, ratio);
}

/// Returns how far a body of the stack has moved at most, in edges.
double drift_of(const CaseText& text, int steps) {
  Simulation simulation = text.start(MPI_COMM_SELF);
  const std::vector<Vec3> start = simulation.bodies().position;
  simulation.run(steps);
  double furthest = 0;
  for (std::size_t row = 0; row < simulation.bodies().owned; ++row)
    furthest = std::max(furthest, (simulation.bodies().position[row] - start[row]).norm());
  return furthest / cube_edge;
}

/// Offsets of a tower of eight that hangs over by a share of the most that statics allows: there the centre
/// of mass of any k topmost boxes is above the rim of the one below them, which is edge / 2k from its middle.
std::vector<double> overhang(double share) {
  std::vector<double> offsets{0};
  for (int k = 7; k >= 1; --k) offsets.push_back(offsets.back() + share * cube_edge / (2 * k));
  return offsets;
}

TEST(DryStability, TowersStandUpToTheGreatestOverhang) {
  EXPECT_LT(drift_of(stack(overhang(0.99)), 5000), 1e-7);
  EXPECT_GT(drift_of(stack(overhang(1.02)), 5000), 0.5);
}

TEST(DryStability, ABoxAThousandTimesAsHeavyOnALightStackStaysWhereItIs) {
  EXPECT_LT(drift_of(stack(std::vector<double>(6, 0.0), 1e3), 5000), 1e-7);
}

TEST(DryStability, ThirtyBoxesCarryOneOfTenThousandTimesTheirMass) {
  EXPECT_LT(drift_of(stack(std::vector<double>(31, 0.0), 1e4), 5000), 1e-5);
}

/// A ball that a free-slip side throws back, or that meets its mirror image at the plane of that side.
CaseText thrown_back(bool image) {
  CaseText c;
  c.fluid.clear();
  c.domain = domain_of({40, 40, 40}, std::string("{ x = \"periodic\", y = \"periodic\", z = ") +
                                         (image ? "\"periodic\" }" : "\"free-slip\" }"));
  c.rest = "[contacts]\nfriction = 0.5\ntwisting_friction = 0.2\nrestitution = 0.6\n";
  c.shapes = sphere_of("ball", 6);
  c.bodies = body_of("ball", 2,
                     "position = [20, 20, 4]\nvelocity = [0.02, 0.01, -0.05]\nangular_velocity = [0.02, "
                     "0.03, 0.01]");
  if (image)
    c.bodies += body_of("ball", 2,
                        "position = [20, 20, 36]\nvelocity = [0.02, 0.01, 0.05]\nangular_velocity = "
                        "[-0.02, -0.03, 0.01]");
  return c;
}

TEST(FreeSlipSides, ThrowABodyBackAsItsMirrorImageDoes) {
  Simulation at_side = thrown_back(false).start(MPI_COMM_SELF),
             at_image = thrown_back(true).start(MPI_COMM_SELF);
  at_side.run(60), at_image.run(60);
  const rigid::BodySet &a = at_side.bodies(), &b = at_image.bodies();
  EXPECT_NEAR(a.velocity[0].z(), 0.6 * 0.05, 1e-9);
  EXPECT_LT((a.velocity[0] - b.velocity[0]).norm(), 1e-12);
  EXPECT_LT((a.angular_velocity[0] - b.angular_velocity[0]).norm(), 1e-12);
  EXPECT_LT((a.angular_velocity[0] - Vec3(0.02, 0.03, 0.01)).norm(), 1e-12);
}

double kinetic_energy(const Simulation& simulation) {
  double sum = 0;
  for (std::size_t row = 0; row < simulation.bodies().owned; ++row)
    sum += simulation.bodies().kinetic_energy(row);
  return sum;
}

TEST(DryStability, AGasWithoutLossKeepsItsEnergy) {
  Simulation simulation = gas().start(MPI_COMM_SELF);
  const double start = kinetic_energy(simulation);
  simulation.run(100000);
  EXPECT_GT(simulation.counters().contacts, 50000u);
  EXPECT_NEAR(kinetic_energy(simulation) / start, 1, 1e-10);
}

std::string stop_of(Simulation&& simulation, std::int64_t steps) {
  return tests::error_of<GuardStop>([&] { simulation.run(steps); });
}

/// A ball of a diameter of 1 against a plate of a thickness of 0.4.
CaseText bullet(double speed) {
  CaseText c;
  c.domain = domain_of({40, 10, 10});
  c.fluid.clear();
  c.rest = "[contacts]\nrestitution = 0.5\nmargin = 0.2\n";
  c.shapes = shape_of("ball", "sphere", "radius = 0.5") + shape_of("plate", "box", "edges = [0.4, 8, 8]");
  c.bodies = body_of("plate", 1, "motion = \"fixed\"\nposition = [20, 5, 5]") +
             body_of("ball", 1, "position = [5.13, 5, 5]\nvelocity = [" + std::to_string(speed) + ", 0, 0]");
  return c;
}

/// Returns the ball's velocity when it has had the time to reach the plate, over that at the start.
double rebound(double speed, double shift, const Overrides& overrides = {}) {
  Simulation simulation = bullet(speed).start(MPI_COMM_SELF, overrides);
  simulation.set_pose(2, {Vec3(5 + shift, 5, 5), rigid::Quat::Identity()});
  simulation.run(static_cast<std::int64_t>(16 / speed) + 2);
  return simulation.bodies().velocity[simulation.bodies().row_of(2)][0] / speed;
}

TEST(ContactGuards, WhatMovesAsFarAsTheyAllowDoesNotPassAPlate) {
  const double furthest = MotionLimits(bullet(0.1).read()).of(0);
  EXPECT_DOUBLE_EQ(furthest, 0.6);
  for (double shift = 0; shift < 0.6; shift += 0.05)
    EXPECT_NEAR(rebound(furthest, shift), -0.5, 1e-9) << shift;
}

TEST(ContactGuards, WhatMovesFurtherIsRefusedWithACure) {
  const std::string fault = bullet(3).fault();
  EXPECT_TEXT(fault, "raise contacts.substeps to 5");
  for (double shift = 0; shift < 0.6; shift += 0.05)
    EXPECT_NEAR(rebound(3, shift, {"contacts.substeps=5"}), -0.5, 1e-9) << shift;
}

TEST(ContactGuards, WhatFallsTooFastIsStoppedWithACure) {
  CaseText c = bullet(0.5);
  c.rest += "[gravity]\nacceleration = [0.03, 0, 0]\n";
  const std::string found = stop_of(c.start(MPI_COMM_SELF), 50);
  EXPECT_TEXT(found, "body 2 moves 0.62 cells in a step; at most 0.6 is possible");
  EXPECT_TEXT(found, "use contacts.substeps = 2");
  EXPECT_EQ(stop_of(c.start(MPI_COMM_SELF, {"contacts.substeps=2"}), 50), "");
}

}  // namespace
}  // namespace silt::testing

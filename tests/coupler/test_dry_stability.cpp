// Bodies alone, by sffd, at the edge of what it can do: towers that theory just lets stand, heavy on
// light, and a gas that nothing may slow down. Cells of 0.1 m, steps of a millisecond.
#include <gtest/gtest.h>

#include <algorithm>

#include "coupler/case/case.hpp"
#include "coupler/simulation.hpp"
#include "tests/coupler/gas.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Vec3;

constexpr double cube_edge = 2;
/// One box on the other, in the field of the earth, the k-th above the lowest at offsets[k] along x; the
/// topmost `ratio` times as heavy as the others.
CaseText stack(const std::vector<double>& offsets, double ratio = 1) {
  CaseText c;
  const int n = static_cast<int>(offsets.size());
  c.domain = domain_of({40, 20, 2 * n + 10},
                       "{ x = \"periodic\", y = \"periodic\", z = [\"no-slip\", \"no-slip\"] }");
  c.fluid.clear();
  c.rest = "[gravity]\nacceleration = [0, 0, -9.81e-5]\n[contacts]\nfriction = 0.5\nmargin = 0.2\n";
  c.shapes = shape_of("box", "box", "edges = [2, 2, 2]");
  c.bodies.clear();
  for (int k = 0; k < n; ++k)
    c.bodies += body_of("box", k + 1 == n ? ratio : 1,
                        "position = [" + std::to_string(10 + offsets[k]) + ", 10, " +
                            std::to_string((k + 0.5) * cube_edge) + "]");
  return c;
}

/// How far a body of the stack has moved at most, in edges.
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
/// of mass of any k topmost boxes is above the rim of the one below them, which is edge / 2k from its
/// middle.
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

}  // namespace
}  // namespace silt::coupler::testing

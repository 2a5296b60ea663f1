// One pass over links instead of two: what a step defers comes later, and no disturbance grows.
#include <gtest/gtest.h>

#include <cmath>

#include "silt/simulation.hpp"
#include "tests/coupler/forces/two_spheres.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Vec3;

/// Velocities of the first sphere along z relative to the fluid, step by step, over its weight in the fluid,
/// which holds the weight of both.
std::vector<double> speeds(double density, const Overrides& coupling) {
  constexpr double sphere = M_PI / 6 * 12 * 12 * 12, fluid = 20 * 22 * 44 - 2 * sphere;
  const double lift = (density - 1) * 2 * sphere / fluid * 3e-5;
  Simulation s = two_spheres(density, density, coupling, MPI_COMM_SELF,
                             "body_force = [0, 0, " + std::to_string(lift * 1e6) + "e-6]\n");
  const double relative = (1 + density * 2 * sphere / fluid) / (density - 1);  // no momentum in all
  std::vector<double> v;
  for (int t = 0; t < 400; ++t) s.step(), v.push_back(s.bodies().velocity[0][2] * relative);
  return v;
}

struct Difference {
  double start = 0, end = 0;  // largest, parts of the terminal velocity; the end from step 300 on
};

Difference difference(const std::vector<double>& a, const std::vector<double>& b) {
  Difference d;
  for (std::size_t t = 0; t < a.size(); ++t) {
    double& largest = t < 300 ? d.start : d.end;
    largest = std::max(largest, std::fabs((a[t] - b[t]) / b.back()));
  }
  printf("difference of the steps: %.3f %% at most, %.3f %% in the end\n", 100 * d.start, 100 * d.end);
  return d;
}

/// The largest change of velocity in a step from rest on, parts of the terminal one.
double largest_change(const std::vector<double>& v) {
  double largest = std::fabs(v[0]);
  for (std::size_t t = 1; t < v.size(); ++t) largest = std::max(largest, std::fabs(v[t] - v[t - 1]));
  return largest / std::fabs(v.back());
}

// The spheres start from rest, at an eigenvalue of 0.19: half of the load comes a step later, and what the
// virtual mass takes with it, but in the end all has come.
TEST(OnePass, GivesWhatItDefers) {
  const auto deferred = speeds(nearly_heavy, {implicit}), at_once = speeds(nearly_heavy, {explicit_});
  const double change = largest_change(at_once);
  const Difference d = difference(deferred, at_once);
  EXPECT_LT(d.start, (0.5 + 0.19) * change);
  EXPECT_LT(d.end, 5e-4);
  EXPECT_GT(d.start, 0.2 * change) << "are these two steps?";
}

// Where a body becomes heavy enough for one pass, the half that comes a step later is all that changes.
TEST(OnePass, AgreesWithTwoWhereItTakesOver) {
  const auto once = speeds(1.02 * least_of_one_pass, {implicit}),
             twice = speeds(0.98 * least_of_one_pass, {implicit});
  const double change = largest_change(twice);
  const Difference d = difference(once, twice);
  const double more_inertia = 0.04 * least_of_one_pass / (least_of_one_pass + 0.5);  // with its added mass
  EXPECT_LT(d.start, 0.5 * change + more_inertia);
  EXPECT_LT(d.end, 5e-4);
  EXPECT_GT(d.start, 0.2 * change) << "are these two steps?";
}

/// Velocities of a body that was set off in a box twice as wide, through the last three of so many steps.
std::vector<Vec3> last_velocities(const std::string& shape, double density, double relaxation_time,
                                  const std::string& walls, int width, int steps) {
  CaseText c;
  c.domain = domain_of({2 * width, 2 * width, 2 * width});
  c.fluid = "[fluid]\nrelaxation_time = " + std::to_string(relaxation_time) + "\n";
  c.rest = "[coupling]\nwall_scheme = \"" + walls + "\"\n";
  c.shapes = shape;
  const std::string x = std::to_string(width);
  c.bodies = body_of("body", density,
                     "position = [" + x + ".13, " + x + ".31, " + x +
                         ".47]\nvelocity = [0.01, 0.006, 0.004]\nangular_velocity = [0.0015, 0.003, -0.002]");
  Simulation s = c.start(MPI_COMM_SELF);
  std::vector<Vec3> v;
  for (int t = 0; t < steps; ++t) {
    s.step();
    if (t >= steps - 3) v.push_back(s.bodies().velocity[0]);
  }
  return v;
}

// The mean of two steps: without it this cube is lost within 500 steps, with a virtual mass of H.
TEST(OnePass, DampsWhatChangesItsSignInEveryStep) {
  const auto v = last_velocities(shape_of("body", "box", "edges = [7.2, 7.2, 7.2]"), 2, 1, "cli", 8, 1500);
  EXPECT_LT((v[0] - 2 * v[1] + v[2]).norm(), 1e-7);
}

TEST(OnePass, IsStableWithinItsLimit) {
  for (const double relaxation_time : {0.52, 0.6, 1.0, 1.8}) {
    const double relaxation = relaxation_time - 0.5,
                 limit = std::min({4 * relaxation, 1.0, 0.8 / relaxation});
    const double density = 1.1 * 5 / (6 * limit);
    const auto v =
        last_velocities(sphere_of("body", 6), density, relaxation_time, "multireflection", 6, 3000);
    EXPECT_LT((v[1] - v[0]).norm(), 2e-6) << relaxation_time;
  }
}

}  // namespace
}  // namespace silt::coupler::testing

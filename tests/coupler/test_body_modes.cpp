// Disturbances of bodies in fluid at rest die away, whatever the body weighs: neither walls nor the coupling
// in time feed them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "coupler/simulation.hpp"
#include "lbm/wall_scheme.hpp"
#include "tests/coupler/case/case_text.hpp"
#include "tests/coupler/stirred_fluid.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Vec3;

constexpr int box_edge = 12;   // of the periodic box, cells
constexpr double size = 1e-6;  // of the disturbance, cells a step: bodies cross no cell, nothing but linear

/// A body at a place and orientation of no symmetry, so many times as heavy as the fluid (0: it is held).
CaseText scene(const std::string& shape, double density, double tau, std::string_view collision) {
  CaseText c;
  c.domain = domain_of({box_edge, box_edge, box_edge}, "\"periodic\"");
  c.fluid = fmt::format("[fluid]\nrelaxation_time = {}\ncollision = \"{}\"\nprecision = \"double\"\n", tau,
                        collision);
  c.shapes = "[[shapes]]\nname = \"body\"\n" + shape;
  c.bodies = body_of(
      "body", density > 0 ? density : 1,
      std::string("position = [6.13, 5.71, 6.37]\naxis_angle = { axis = [3, 1, -2], degrees = 67 }\n") +
          (density > 0 ? "" : "motion = \"fixed\"\n"));
  return c;
}

/// Root mean square of the fluid's velocity about its mean, and the body's difference from it.
double disturbance(const Simulation& s) {
  const FluidFields& fields = s.scene().flow->fields();
  Vec3 sum = Vec3::Zero();
  double square = 0;
  int count = 0;
  for_each_cell(fields, [&](int b, lbm::Int3 x, lbm::Int3) {
    if (!fields.is_fluid(b, x)) return;
    const Vec3 v = velocity(fields, b, x);
    sum += v, square += v.squaredNorm(), ++count;
  });
  const Vec3 mean = sum / count;
  return std::sqrt(std::max(0.0, square / count - mean.squaredNorm())) +
         (s.bodies().velocity[0] - mean).norm();
}

constexpr const char* shapes[] = {"type = \"sphere\"\ndiameter = 6\n",
                                  "type = \"box\"\nedges = [4.7, 4.7, 4.7]\n"};

/// A disturbance after 3000 steps, when what fades quickly has, and after 4000.
std::pair<double, double> disturbances(const std::string& shape, double density, double tau,
                                       std::string_view collision) {
  Simulation s = scene(shape, density, tau, collision).start(MPI_COMM_SELF);
  stir(s.scene().flow->fields(), size);
  s.run(3000);
  const double early = disturbance(s);
  s.run(1000);
  return {early, disturbance(s)};
}

void expect_decay(std::string_view collision, std::initializer_list<double> densities,
                  std::initializer_list<double> taus) {
  constexpr double rounding = 1e-4 * size;  // of the forces' quanta
  for (const char* const shape : shapes)
    for (const double density : densities)
      for (const double tau : taus) {
        const auto [early, late] = disturbances(shape, density, tau, collision);
        EXPECT_LT(late, std::max(early, rounding))
            << collision << ", " << shape << "density " << density << ", tau " << tau;
      }
}
TEST(BodyModes, DisturbancesDieAway) {
  expect_decay("trt", {0.0, 0.02, 0.2, 1.0, 20.0}, {0.502, 0.51, 0.7, 3.0});
}
TEST(BodyModes, DisturbancesDieAwayWithRegularised) {
  expect_decay("regularised", {0.0, 0.2, 5.0}, {0.502, 0.51, 0.7});
}

/// A heavy cube let go while it turns about an axis of no symmetry, its edges across many cells in a turn.
CaseText spinning_cube(double tau, std::string_view wall_scheme) {
  CaseText c;
  c.domain = domain_of({18, 18, 18}, "\"no-slip\"");
  c.fluid = fmt::format("[fluid]\nrelaxation_time = {}\n", tau);
  c.rest = fmt::format("[coupling]\nwall_scheme = \"{}\"\n", wall_scheme);
  c.shapes = shape_of("cube", "box", "edges = [6.2, 6.2, 6.2]");
  c.bodies = body_of("cube", 30,
                     "position = [9.13, 8.71, 9.37]\naxis_angle = { axis = [3, 1, -2], degrees = 67 }\n"
                     "angular_velocity = [0.012, -0.006, 0.009]\n");
  return c;
}

TEST(BodyModes, ASpinningCubeComesToRest) {
  for (const auto wall_scheme : lbm::wall_scheme_names)
    for (const double tau : {0.55, 0.8, 2.0}) {
      SCOPED_TRACE(fmt::format("{}, tau {}", wall_scheme, tau));
      Simulation s = spinning_cube(tau, wall_scheme).start(MPI_COMM_SELF);
      double before = s.bodies().angular_velocity[0].norm(), turned = 0;
      while (before > 1e-5 && s.steps_done() < 5000) {
        for (int t = 0; t < 25; ++t) s.step(), turned += s.bodies().angular_velocity[0].norm();
        const double now = s.bodies().angular_velocity[0].norm();
        ASSERT_LT(now, before) << "after " << s.steps_done() << " steps";
        before = now;
      }
      EXPECT_GT(turned, 0.5);
      EXPECT_LT(s.bodies().velocity[0].norm(), 2e-4);  // it has no cause to go anywhere
    }
}

}  // namespace
}  // namespace silt::coupler::testing

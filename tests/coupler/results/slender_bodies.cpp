// Needles and discs of every shape, as long as thick up to 1000 times: a case of one is sound, runs and is
// drawn; its mass is that of the formula.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "coupler/case/case.hpp"
#include "coupler/results/body_output.hpp"
#include "coupler/simulation.hpp"
#include "tests/coupler/case/case_text.hpp"

namespace silt::coupler::testing {
namespace {

constexpr double length = 200;

struct Slender {
  std::string type, sizes;
  double volume;
};

/// The corners of a prism of n sides about z.
std::string prism(double radius, double height, int n) {
  std::string list;
  for (int i = 0; i < 2 * n; ++i) {
    const double angle = 2 * std::numbers::pi * (i % n) / n;
    list += fmt::format("{}[{:.17g}, {:.17g}, {}]", i ? ", " : "", radius * std::cos(angle),
                        radius * std::sin(angle), i < n ? 0 : height);
  }
  return "vertices = [" + list + "]";
}

/// Of width `across` and height `along`.
std::vector<Slender> solids(double across, double along) {
  constexpr double pi = std::numbers::pi;
  const auto rod = [&](const char* height) {
    return fmt::format("diameter = {}\n{} = {}", across, height, along);
  };
  const double middle = std::sqrt(across * along), disc = pi / 4 * across * across;
  std::vector<Slender> all = {
      {"ellipsoid", fmt::format("diameters = [{0}, {0}, {1}]", across, along), 2. / 3 * disc * along},
      {"ellipsoid", fmt::format("diameters = [{}, {}, {}]", across, middle, along),
       pi / 6 * across * middle * along},
      {"cylinder", rod("length"), disc * along},
      {"cone", rod("height"), disc * along / 3},
      {"box", fmt::format("edges = [{0}, {0}, {1}]", across, along), across * across * along},
      {"polyhedron", prism(across / 2, along, 12), 6 * std::sin(pi / 6) * across * across / 4 * along},
      {"polyhedron", prism(across / 2, along, 200), 100 * std::sin(pi / 100) * across * across / 4 * along},
      {"polyhedron",
       fmt::format("vertices = [[0, 0, 0], [{0}, 0, 0], [0, {0}, 0], [0, 0, {1}]]", across, along),
       across * across * along / 6}};
  if (along > across) all.push_back({"capsule", rod("length"), disc * along + 2. / 3 * disc * across});
  return all;
}

TEST(SlenderBodies, AreSoundRunAndAreDrawn) {
  CaseText c;
  c.domain = domain_of({480, 480, 480});
  c.fluid = "";
  for (const double thick : {length / 24, length / 100, length / 1000})
    for (const bool needle : {true, false})
      for (const Slender& solid : needle ? solids(thick, length) : solids(length, thick)) {
        SCOPED_TRACE(solid.type + ", " + solid.sizes.substr(0, 60));
        c.shapes = shape_of("body", solid.type, solid.sizes);
        c.bodies = body_of("body", 2, "position = [240, 240, 240]\nangular_velocity = [1e-5, 0, 0]");
        const Case scene = c.read();
        EXPECT_FALSE(has_errors(judgement(scene)));
        Simulation simulation(scene, MPI_COMM_SELF);
        simulation.run(1);
        EXPECT_NEAR(simulation.bodies().mass[0], 2 * solid.volume, 1e-9 * solid.volume);
        const auto kinds = drawn_kinds(scene);
        ASSERT_EQ(kinds.size(), 1u);
        EXPECT_GE(kinds[0].parts.at(0).triangles.size(), 4u);
      }
}

/// A polyhedron of corners on an ellipsoid, turned: every corner of it is one of its hull's.
TEST(SlenderBodies, KeepAllCornersOfTheirHulls) {
  const rigid::Quat turn = rigid::Quat(0.3, 0.5, -0.2, 0.7).normalized();
  for (const double thin : {1 / 24., 1e-2, 1e-3}) {
    std::string list;
    for (int i = 0; i < 200; ++i) {
      const double z = 1 - (2 * i + 1.) / 200, angle = i * std::numbers::pi * (3 - std::sqrt(5.)),
                   r = std::sqrt(1 - z * z);
      const rigid::Vec3 x =
          length / 2 *
          (turn * rigid::Vec3(thin * r * std::cos(angle), std::sqrt(thin) * r * std::sin(angle), z));
      list += fmt::format("{}[{:.17g}, {:.17g}, {:.17g}]", i ? ", " : "", x[0], x[1], x[2]);
    }
    CaseText c;
    c.domain = domain_of({480, 480, 480});
    c.fluid = "";
    c.shapes = shape_of("body", "polyhedron", "vertices = [" + list + "]");
    c.bodies = body_of("body", 2, "position = [240, 240, 240]");
    Simulation simulation(c.read(), MPI_COMM_SELF);
    const double ellipsoid = std::numbers::pi / 6 * std::pow(length, 3) * std::pow(thin, 1.5);
    EXPECT_NEAR(simulation.bodies().mass[0] / 2, 0.9704211141 * ellipsoid, 1e-9 * ellipsoid)
        << "as of the 200 points on a sphere";
  }
}

}  // namespace
}  // namespace silt::coupler::testing

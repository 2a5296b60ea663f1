// Heat between fluid and surfaces, against theory: where it goes, how fast, and that none is lost.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>

#include "silt/case/case.hpp"
#include "silt/results/quantities.hpp"
#include "silt/simulation.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::coupler::testing {
namespace {

using silt::testing::body_of;
using silt::testing::CaseText;
using silt::testing::domain_of;
using silt::testing::simulation_of;
using silt::testing::sphere_of;

std::string quantity(const std::string& type, const std::string& lines = "") {
  return fmt::format("[[quantities]]\nname = \"{}\"\ntype = \"{}\"\n{}\n", type, type, lines);
}

double value(const Simulation& s, const std::string& name) {
  return Quantities(s.setup()).evaluate(s, name);
}

/// Returns the rate at which a round rod of fluid cools in a tube at the temperature 2, relative to that
/// of the first mode of Bessel's equation, less 1.
double cooling_error(double radius, double diffusivity) {
  const int across = 2 * int(radius + 3);
  CaseText c;
  c.domain = domain_of({across, across, 2});
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nprecision = \"double\"\n";
  c.shapes = c.bodies = "";
  c.rest = fmt::format(
      "[heat]\nthermal_diffusivity = {}\ninitial = 3\n[[walls]]\ntype = \"tube\"\nname = \"tube\"\naxis = "
      "\"z\"\n"
      "radius = {}\npoint = [{}, {}, 0]\ntemperature = 2\n",
      diffusivity, radius, across / 2 + 0.13, across / 2 - 0.37);
  c.rest += quantity("mean-temperature");
  Simulation s = simulation_of(c.text());
  const double rate = diffusivity * std::pow(2.404825557695773 / radius, 2);
  const auto go_to = [&](double time) {
    while (double(s.steps_done()) < time) s.step();
    return value(s, "mean-temperature") - 2;
  };
  const double start = 2 / rate;  // the second mode has then faded by e^-8.5 against the first
  const double before = go_to(start);
  const double steps = double(s.steps_done());
  const double after = go_to(2 * start);
  return std::log(before / after) / ((double(s.steps_done()) - steps) * rate) - 1;
}

TEST(BodyHeat, TubeCoolsAsBesselSaysToSecondOrder) {
  for (const double diffusivity : {0.05, 0.1}) {
    const double coarse = cooling_error(5.2, diffusivity), fine = cooling_error(10.4, diffusivity);
    printf("diffusivity %g: errors %.4f, %.4f\n", diffusivity, coarse, fine);
    EXPECT_LT(std::abs(coarse), 0.01);
    EXPECT_LT(std::abs(fine), 0.002);
  }
}

/// A warm ball with a heat capacity that is towed through fluid in a periodic box.
CaseText towed_ball(const std::string& precision, const std::string& heat) {
  CaseText c;
  c.domain = domain_of({20, 16, 16});
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nprecision = \"" + precision + "\"\n";
  c.shapes = sphere_of("ball", 7);
  c.bodies = body_of(
      "ball", 2, "motion = \"prescribed\"\nvelocity = [0.03, 0.01, 0]\nposition = [6.3, 8.2, 7.9]\n" + heat);
  c.rest = "[heat]\nthermal_diffusivity = 0.08\ninitial = 0.5\n" + quantity("stored-heat") +
           quantity("heat-flow") + quantity("mean-temperature") + quantity("body-temperature");
  return c;
}

TEST(BodyHeat, NoneIsLostAsAMovingBodyCools) {
  for (const char* precision : {"double", "single"})
    for (const char* heat :
         {"temperature = 3\nheat_capacity = 0.7", "temperature = 3\nheat_capacity = 0.002", ""}) {
      Simulation s = simulation_of(towed_ball(precision, heat).text());
      const double before = value(s, "stored-heat");
      for (int t = 0; t < 400; ++t) s.step();
      EXPECT_GT(s.counters().uncovered, 0u);
      const double tolerance = std::string(precision) == "double" ? 1e-9 : 2e-5;
      EXPECT_NEAR(value(s, "stored-heat") / before, 1, tolerance) << precision << " " << heat;
    }
}

/// A light capacity takes the temperature of the fluid around it within steps, and does not swing.
TEST(BodyHeat, LightCapacityFollowsTheFluid) {
  Simulation s = simulation_of(towed_ball("single", "temperature = 3\nheat_capacity = 0.0001").text());
  for (int t = 0; t < 300; ++t) s.step();
  EXPECT_NEAR(value(s, "body-temperature"), 0.5, 0.02);
}

/// An insulating ball moves through fluid that is as warm everywhere, and leaves it so.
TEST(BodyHeat, InsulatingBodyLeavesUniformFluidAsItIs) {
  Simulation s = simulation_of(towed_ball("double", "").text());
  const FluidFields& fields = s.scene().flow->fields();
  for (int t = 0; t < 400; ++t) s.step();
  double most = 0;
  lbm::for_cells({}, fields.block(0).size, [&](lbm::Int3 x) {
    if (fields.is_fluid(0, x)) most = std::max(most, std::abs(fields.temperature(0, x) / 0.5 - 1));
  });
  printf("largest deviation %.4f\n", most);
  EXPECT_LT(most, 0.03);
}

/// Returns the conductivity of a simple cubic array of insulating spheres over the fluid's: between two
/// planes a sphere of `edge` cells in a cube lies off the middle of the cells.
double conductivity_of_array(int edge, double diameter) {
  CaseText c;
  c.domain = domain_of({edge, edge, edge},
                       "{ x = \"periodic\", y = \"periodic\", z = [{ type = \"no-slip\", temperature = 0.5 "
                       "}, { type = \"no-slip\", temperature = -0.5 }] }");
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nprecision = \"double\"\n";
  c.shapes = sphere_of("ball", diameter);
  c.bodies = body_of("ball", 1,
                     fmt::format("motion = \"fixed\"\nposition = [{}, {}, {}]\n", edge / 2 + 0.21,
                                 edge / 2 - 0.33, edge / 2.));
  c.rest = "[heat]\nthermal_diffusivity = 0.25\n" + quantity("heat-flow", "side = \"z-low\"");
  Simulation s = simulation_of(c.text());
  while (s.steps_done() < 3 * edge * edge) s.step();
  return value(s, "heat-flow") / (0.25 * edge);
}

/// Sangani, Acrivos, Proc. R. Soc. A 386 (1983) 263; solid fractions 0.1 and 0.3. A surface of steps of whole
/// cells lets 2.3 and 7 % too little heat through.
TEST(BodyHeat, InsulatingSpheresLetHeatThroughAsSanganiAndAcrivosSay) {
  EXPECT_NEAR(conductivity_of_array(14, 14 * std::cbrt(0.6 / M_PI)) / 0.85711, 1, 0.005);
  EXPECT_NEAR(conductivity_of_array(10, 10 * std::cbrt(1.8 / M_PI)) / 0.60566, 1, 0.01);
}

/// Along an insulating tube across the cells heat flows as through its true cross-section: its rate over that
/// is the diffusivity times the slope of the temperature, far from the ends.
TEST(BodyHeat, ObliqueInsulatingTubeConductsByItsCrossSection) {
  constexpr double radius = 5, diffusivity = 0.25;
  const rigid::Vec3 axis = rigid::Vec3(1, 0.3, 2).normalized(), point(3, 4.2, -6);
  CaseText c;
  c.domain = domain_of({29, 18, 32},
                       "{ x = \"no-slip\", y = \"no-slip\", z = [{ type = \"no-slip\", temperature = 0.5 }, "
                       "{ type = \"no-slip\", temperature = -0.5 }] }");
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nprecision = \"double\"\n";
  c.shapes = c.bodies = "";
  c.rest = fmt::format(
      "[heat]\nthermal_diffusivity = {}\n[[walls]]\ntype = \"tube\"\nname = \"tube\"\naxis = [1, 0.3, 2]\n"
      "radius = {}\npoint = [3, 4.2, -6]\n",
      diffusivity, radius);
  c.rest += quantity("heat-flow", "side = \"z-low\"");
  Simulation s = simulation_of(c.text());
  while (s.steps_done() < 3500) s.step();
  const FluidFields& fields = s.scene().flow->fields();
  double n = 0, along = 0, t = 0, square = 0, product = 0;
  lbm::for_cells({0, 0, 12}, {29, 18, 20}, [&](lbm::Int3 x) {
    if (!fields.is_fluid(0, x)) return;
    const double way = axis.dot(rigid::Vec3(x.x + 0.5, x.y + 0.5, x.z + 0.5) - point);
    const double here = fields.temperature(0, x);
    n += 1, along += way, t += here, square += way * way, product += way * here;
  });
  const double slope = (product - along * t / n) / (square - along * along / n);
  EXPECT_NEAR(value(s, "heat-flow") / (-slope * diffusivity * M_PI * radius * radius), 1, 0.01);
}

/// A body with a source in a closed box: all heat is in fluid and body.
TEST(BodyHeat, SourceWarmsBodyAndFluid) {
  CaseText c = towed_ball("double", "temperature = 0.5\nheat_capacity = 1\nheat_source = 0.25");
  Simulation s = simulation_of(c.text());
  const double before = value(s, "stored-heat");
  for (int t = 0; t < 200; ++t) s.step();
  EXPECT_NEAR(value(s, "stored-heat") - before, 200 * 0.25, 1e-6);
  EXPECT_GT(value(s, "body-temperature"), 0.5);
}

/// Between two sides at given temperatures and four that insulate heat flows as in a slab.
TEST(BodyHeat, SlabConducts) {
  CaseText c;
  c.domain =
      "[domain]\nsize = [4, 3, 10]\nboundary.x = \"no-slip\"\nboundary.y = \"free-slip\"\n"
      "boundary.z = [{ type = \"no-slip\", temperature = 7 }, { type = \"no-slip\", temperature = 5 }]\n";
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nprecision = \"double\"\n";
  c.shapes = c.bodies = "";
  c.rest = "[heat]\nthermal_diffusivity = 0.3\ntemperature = 5\n" +
           quantity("heat-flow", "side = \"z-low\"") + quantity("nusselt-number", "side = \"z-high\"") +
           quantity("mean-temperature");
  Simulation s = simulation_of(c.text());
  for (int t = 0; t < 4000; ++t) s.step();
  EXPECT_NEAR(value(s, "heat-flow"), 0.3 * 2 / 10 * 12, 1e-9);
  EXPECT_NEAR(value(s, "nusselt-number"), 1, 1e-9);
  EXPECT_NEAR(value(s, "mean-temperature"), 6, 1e-9);
}

}  // namespace
}  // namespace silt::coupler::testing

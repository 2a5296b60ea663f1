// Heat between fluid and surfaces, against theory: where it goes, how fast, and that none is lost.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <numbers>

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

/// Fluid at rest between two sides and four that insulate: heat flows as in a slab, between two temperatures,
/// and from a side that gives heat to one that has a temperature.
TEST(BodyHeat, SlabConducts) {
  constexpr double cold = 3, height = 10, area = 12, diffusivity = 0.3, flux = 0.02;
  for (const bool given : {false, true}) {
    const double warm = given ? cold + flux * height / diffusivity : 7;
    CaseText c;
    c.domain = fmt::format(
        "[domain]\nsize = [4, 3, 10]\nboundary.x = \"no-slip\"\nboundary.y = \"free-slip\"\n"
        "boundary.z = [{{ type = \"no-slip\", {} }}, {{ type = \"no-slip\", temperature = {} }}]\n",
        given ? fmt::format("heat_flux = {}", flux) : fmt::format("temperature = {}", warm), cold);
    c.fluid = "[fluid]\nrelaxation_time = 0.8\nprecision = \"double\"\n";
    c.shapes = c.bodies = "";
    c.rest = "[heat]\nthermal_diffusivity = 0.3\ntemperature = 3\n" +
             quantity("heat-flow", "side = \"z-high\"") + quantity("mean-temperature");
    if (!given) c.rest += quantity("nusselt-number", "side = \"z-high\"");
    Simulation s = simulation_of(c.text());
    s.run(given ? 12000 : 4000);
    EXPECT_NEAR(value(s, "heat-flow"), -diffusivity * (warm - cold) / height * area, 1e-9) << given;
    EXPECT_NEAR(value(s, "mean-temperature"), (warm + cold) / 2, 1e-9) << given;
    if (!given) {
      EXPECT_NEAR(value(s, "nusselt-number"), 1, 1e-9);
    }
  }
}

/// A hot lump, as light as a hundredth of the fluid that it displaces, in an insulating box comes to one
/// temperature with the fluid, and never swings beyond.
TEST(BodyHeat, OfALumpGoesIntoTheFluid) {
  constexpr double diameter = 8, capacity = 0.01;
  const double volume = std::numbers::pi / 6 * std::pow(diameter, 3);
  CaseText c;
  c.domain = domain_of({16, 16, 16}, "\"no-slip\"");
  c.rest = "[heat]\nthermal_diffusivity = 0.2\n";
  c.shapes = sphere_of("ball", diameter);
  c.bodies = body_of(
      "ball", 1, "motion = \"fixed\"\nposition = [8.1, 7.9, 8.3]\ntemperature = 50\nheat_capacity = 0.01");
  c.run = quantity("body-temperature") + quantity("mean-temperature") + "[run]\nsteps = 3000\n";
  const double mixed = 50 * capacity * volume / (16 * 16 * 16 - volume + capacity * volume);
  Simulation s = c.start(MPI_COMM_SELF);
  for (int k = 0; k < 20; ++k) {
    s.step();
    const double ball = value(s, "body-temperature");
    EXPECT_LT(ball, 50.0);
    EXPECT_GT(ball, 0.9 * mixed) << "after " << s.steps_done() << " steps";
  }
  s.run(2980);
  EXPECT_NEAR(value(s, "body-temperature") / mixed, 1, 0.02);
  EXPECT_NEAR(value(s, "mean-temperature") / value(s, "body-temperature"), 1, 1e-4);
}

/// Asks for what flows in through the low side along x, and for the mean temperature.
const std::string through_x =
    "[[quantities]]\nname = \"in\"\ntype = \"heat-flow\"\nside = \"x-low\"\n"
    "[[quantities]]\nname = \"mean\"\ntype = \"mean-temperature\"\n";

/// A cubic array of spheres, 0.3 of the volume, across the sides along the gradient.
double conductivity_of_array(const std::string& sphere) {
  constexpr int edge = 10;
  constexpr double diffusivity = 0.25, gradient = 0.2;
  CaseText c;
  c.domain = domain_of({edge, edge, edge});
  c.fluid = "[fluid]\nrelaxation_time = 1.0\n";
  c.rest = "[heat]\nthermal_diffusivity = 0.25\nmean_gradient = [0.2, 0, 0]\n";
  c.shapes = sphere_of("ball", edge * std::cbrt(6 * 0.3 / std::numbers::pi));
  c.bodies = body_of("ball", 1, "motion = \"fixed\"\nposition = [5.1, 0.2, 9.7]\n" + sphere);
  c.run = "[run]\nsteps = 400\n" + through_x;
  return c.values(MPI_COMM_SELF)[0] / (-diffusivity * gradient * edge * edge);
}

/// Sangani, Acrivos, Proc. R. Soc. A 386 (1983) 263: scripts/accuracy/reference/conduction_arrays.csv.
TEST(MeanGradient, IsConductedThroughAnArray) {
  EXPECT_NEAR(conductivity_of_array("") / 0.60566, 1, 0.01);
  EXPECT_NEAR(conductivity_of_array("temperature = 0\n") / 2.33288, 1, 0.015);
}

/// Between insulating plates 2 h apart heat spreads in a stream of Pe = U h/D by D (1 + 2/105 Pe^2), besides
/// what the stream carries (Taylor, Aris).
TEST(MeanGradient, SpreadsInAStreamByTheLawOfTaylorAndAris) {
  constexpr int gap = 16, steps = 4000;
  constexpr double diffusivity = 0.02, gradient = 0.1, push = 1.2e-4;
  CaseText c;
  c.domain = domain_of({4, 4, gap}, R"({ x = "periodic", y = "periodic", z = ["no-slip", "no-slip"] })");
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nprecision = \"double\"\nbody_force = [1.2e-4, 0, 0]\n";
  c.rest = "[heat]\nthermal_diffusivity = 0.02\nmean_gradient = [0.1, 0, 0]\n";
  c.shapes = c.bodies = "";
  c.run = "[run]\nsteps = 4000\n" + through_x;
  Simulation s = c.start(MPI_COMM_SELF);
  s.run(steps);
  const double speed = s.checked_totals().momentum[0] / (4 * 4 * gap) + push / 2;
  const double flux = value(s, "in") / (4 * gap), peclet = speed * (gap / 2.) / diffusivity;
  const double spread = (speed * value(s, "mean") - flux) / gradient;
  EXPECT_NEAR(spread / diffusivity, 1 + 2. / 105 * peclet * peclet, 0.02 * peclet);
}

}  // namespace
}  // namespace silt::coupler::testing

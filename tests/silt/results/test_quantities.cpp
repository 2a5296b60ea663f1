// The figures of [[quantities]]: what each is worth in scenes whose answer is known.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "silt/case/case.hpp"
#include "silt/case/quantity_spec.hpp"
#include "silt/results/quantities.hpp"
#include "silt/results/quantity_computation.hpp"
#include "silt/simulation.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/silt/results/quantity_scenes.hpp"
#include "tests/world.hpp"

namespace silt::testing {
namespace {

using rigid::Vec3;

double value_of(const CaseText& text) {
  return text.values(MPI_COMM_WORLD, {finely_cut}).front();
}

TEST(Quantities, EveryTypeHasAComputation) {
  for (const QuantityType& type : quantity_types) {
    EXPECT_EQ(computation_of(type.name).type, type.name);
    EXPECT_EQ(computation_of(type.name).in_step.of != nullptr, type.asks_for(QuantityType::stepwise))
        << type.name;
  }
  EXPECT_THROW(computation_of("no-such"), std::logic_error);
}

TEST(Quantities, MotionOfFreeBodiesAcrossTheBorder) {
  const std::string bodies = "positions = [[4, 4, 4], [30, 16, 16]]\nvelocity = [0.25, 0, 0]";
  EXPECT_NEAR(value_of(dry_scene(bodies, "type = \"displacement\"\naxis = \"x\"")), 25, 1e-12);
  EXPECT_NEAR(value_of(dry_scene(bodies, "type = \"displacement\"\naxis = \"y\"")), 0, 1e-12);
  EXPECT_EQ(value_of(dry_scene(bodies, "type = \"mean-velocity\"\naxis = \"x\"")), 0.25);
  EXPECT_EQ(value_of(dry_scene(bodies, "type = \"momentum-change\"\naxis = \"x\"")), 0);
  EXPECT_NEAR(value_of(dry_scene(bodies, "type = \"angular-momentum-change\"")), 0, 1e-14);
  EXPECT_EQ(value_of(dry_scene(bodies, "type = \"energy-change\"")), 0);
}

TEST(Quantities, SpinOfAKind) {
  const std::string bodies =
      "name = \"top\"\nposition = [8, 8, 8]\nangular_velocity = [0, 0.01, 0]\n"
      "[[bodies]]\nshape = \"ball\"\ndensity = 2\nposition = [24, 24, 24]";
  const std::string spin = "type = \"mean-angular-velocity\"\naxis = \"y\"";
  EXPECT_EQ(value_of(dry_scene(bodies, spin)), 0.005);
  EXPECT_EQ(value_of(dry_scene(bodies, spin + "\nbody = \"top\"")), 0.01);
}

/// Falling freely from rest: E stays, v = g t, P gains m g t (but the scale, of rest, is 0: nothing to speak
/// of).
TEST(Quantities, FreeFall) {
  CaseText fall = dry_scene("position = [16, 16, 30]", "type = \"energy-change\"", 50);
  fall.domain = domain_of({32, 32, 64}, R"("no-slip")");
  fall.rest = "[gravity]\nacceleration = [0, 0, -0.01]\n";
  EXPECT_NEAR(value_of(fall), 0, 1e-12);
  fall.run = dry_scene("", "type = \"energy-growth\"", 50).run;
  EXPECT_NEAR(value_of(fall), 0, 1e-12);
  fall.run = dry_scene("", "type = \"momentum-change\"", 50).run;
  EXPECT_TRUE(std::isnan(value_of(fall)));
  fall.run = dry_scene("", "type = \"displacement\"", 50).run;
  EXPECT_NEAR(value_of(fall), -0.5 * 0.01 * 50 * 50, 1e-10);
}

/// A body moves 0.1 cells a step: the mean over 11 steps is its place in the middle one, the deviation that
/// of eleven numbers in a row.
TEST(Quantities, MeanAndDeviationOverSomeSteps) {
  const auto over = [](const std::string& more) {
    return value_of(dry_scene("position = [10, 10, 5]\nvelocity = [0, 0, 0.1]",
                              "type = \"mean-height\"\nover = [10, 20]\n" + more, 40));
  };
  EXPECT_NEAR(over(""), 5 + 1.5, 1e-12);
  EXPECT_NEAR(over("deviation = true"), 0.1 * std::sqrt(10.), 1e-12);
}

/// A ball that stops dead (restitution 0) has lost its kinetic energy, all there is.
TEST(Quantities, EnergyLostInAnImpact) {
  CaseText c = dry_scene("position = [16, 16, 16]\nvelocity = [0.5, 0, 0]", "type = \"energy-change\"");
  c.domain = domain_of({32, 32, 32}, R"("no-slip")");
  EXPECT_NEAR(value_of(c), -1, 1e-12);
  c.run = dry_scene("", "type = \"energy-growth\"").run;
  EXPECT_NEAR(value_of(c), 0, 1e-12) << "the largest is that at the start";
}

/// Simple cubic packing, one ball across the corner of the domain: pi/6; in a slab through the balls' middles
/// the share of a disc.
TEST(Quantities, PackingFraction) {
  const std::string balls =
      "positions = [[0, 0, 0], [8, 0, 0], [16, 0, 0], [24, 0, 0], [0, 8, 0], [8, 8, 0], [16, 8, 0], "
      "[24, 8, 0]]";
  const std::string slab = "type = \"packing-fraction\"\nbox = [[0, 0, 0], [32, 12, 0.25]]";
  const double disc = std::numbers::pi * (16 - 0.0625 / 3) / 64;
  EXPECT_NEAR(value_of(dry_scene(balls, "type = \"packing-fraction\"\nbox = [[0, 0, 0], [32, 12, 4]]", 1)),
              std::numbers::pi / 6, 2e-3);
  EXPECT_NEAR(value_of(dry_scene(balls, slab, 1)), disc, 2e-3);
  EXPECT_NEAR(value_of(dry_scene(balls, "type = \"packing-fraction\"", 1)),
              8 * (4. / 3 * std::numbers::pi) / 512, 1e-14)
      << "bodies all inside";
}

/// The common part of two balls counts once, in a box all round them and in one that cuts them in the middle
/// of the line between them.
TEST(Quantities, PackingFractionOfACompound) {
  CaseText pair = dry_scene("position = [20, 3, 16]\norientation = [0.9, 0.1, 0.3, 0.3]",
                            "type = \"packing-fraction\"", 1);
  pair.shapes = shape_of("ball", "compound",
                         "parts = [{ type = \"sphere\", radius = 4, position = [0, 0, 2] }, "
                         "{ type = \"sphere\", radius = 4, position = [0, 0, -2] }]");
  const double ball = 256. / 3 * std::numbers::pi, lens = 80. / 3 * std::numbers::pi, box = 32 * 32 * 32;
  EXPECT_NEAR(value_of(pair) * box, 2 * ball - lens, 6e-3 * ball);
  pair.bodies = body_of("ball", 2, "position = [20, 3, 16]");
  pair.run += "box = [[0, 0, 16], [32, 32, 32]]\n";
  EXPECT_NEAR(value_of(pair) * box / 2, ball - lens / 2, 6e-3 * ball);
}

/// Balls four cells above one another sink by four and eight: what is below a height at the end, less what
/// was there at `time`, by the time between.
TEST(Quantities, DischargeRate) {
  const std::string row =
      "positions = [[4, 4, 10], [12, 12, 14], [20, 20, 18], [28, 28, 22]]\nvelocity = [0, 0, -0.05]";
  const std::string rate = "type = \"discharge-rate\"\nheight = 8\n";
  const double mass = 2 * 4. / 3 * std::numbers::pi * 64;
  EXPECT_NEAR(value_of(dry_scene(row, rate + "time = 0", 160)), 2 * mass / 160, 1e-9);
  EXPECT_NEAR(value_of(dry_scene(row, rate + "time = 80", 160)), mass / 80, 1e-9);
}

/// A body at 30 degrees from straight down, turned about +y: towards -x.
TEST(Quantities, BedAngle) {
  CaseText c = dry_scene("position = [12, 5, 9.0717967697244912]",
                         "type = \"bed-angle\"\naxis = \"y\"\ncentre = [16, 0, 16]\ntime = 0", 1);
  c.rest = "[gravity]\nacceleration = [0, 0, -1e-12]\n";
  EXPECT_NEAR(value_of(c), 30, 1e-8);
}

/// A weight 3 to the one side of the axis, and one of another kind, which is not asked for.
TEST(Quantities, WeightTorque) {
  CaseText c = dry_scene(
      "position = [13, 5, 9]\nname = \"asked\"",
      "type = \"weight-torque\"\nbody = \"asked\"\naxis = \"y\"\ncentre = [16, 0, 16]\ntime = 0", 1);
  c.bodies += body_of("ball", 1, "position = [25, 25, 25]");
  c.rest = "[gravity]\nacceleration = [0, 0, -1e-12]\n";
  const double volume = 4. / 3 * std::numbers::pi * 64;
  EXPECT_NEAR(value_of(c) / (-3 * volume * 2 * 1e-12), 1, 1e-9);
}

/// A (sin cos cos, -cos sin cos, 0): the mean of u.u/2 is A^2/8, that of S:S is 3/8 (A k)^2.
TEST(Quantities, EnergyAndDissipationOfTheVortexAtItsStart) {
  const double amplitude = 0.02, k = 2 * std::numbers::pi / 32, viscosity = 0.1;
  const double energy = amplitude * amplitude / 8;
  EXPECT_NEAR(value_of(vortex("type = \"kinetic-energy\"\ntime = 0")) / energy, 1, 1e-9);
  EXPECT_NEAR(value_of(vortex("type = \"dissipation\"\ntime = 0")) / (6 * viscosity * k * k * energy), 1,
              1e-9);
}

/// The dissipation is the loss of energy: two ways to the same figure, of the populations' stress and of the
/// velocity. The loss over two steps, in which the energy falls by 5 %, is within 1e-4 of that at the middle.
TEST(Quantities, DissipationIsTheLossOfEnergy) {
  const auto energy = [](int t) {
    return value_of(vortex("type = \"kinetic-energy\"\ntime = " + std::to_string(t), 111));
  };
  const double loss = (energy(109) - energy(111)) / 2;
  EXPECT_NEAR(value_of(vortex("type = \"dissipation\"\ntime = 110", 111)) / loss, 1, 1e-3);
}

/// At the end, and at that time, are the same.
TEST(Quantities, AnInstantIsByDefaultTheEnd) {
  EXPECT_EQ(value_of(vortex("type = \"dissipation\"", 7)),
            value_of(vortex("type = \"dissipation\"\ntime = 7", 9)));
  EXPECT_TRUE(std::isnan(value_of(vortex("type = \"dissipation\"\ntime = 8", 7))));
}

/// Flow between plates, u = g y (H - y) / 2 nu, which the lattice holds exactly (Lambda = 3/16): the mean of
/// nu (du/dy)^2 over the cells' centres is g^2 (H^2 - 1) / 12 nu.
TEST(Quantities, DissipationOfForcedFlow) {
  const double force = 1e-6, height = 8, viscosity = 1. / 6;
  const auto channel = wet_scene(
      "size = [8, 8, 8]\nboundary = { x = \"periodic\", y = \"periodic\", z = \"no-slip\" }",
      "relaxation_time = 1\nmagic = 0.1875\nbody_force = [1e-6, 0, 0]", "type = \"dissipation\"", 3000);
  const double expected = force * force * (height * height - 1) / (12 * viscosity);
  EXPECT_NEAR(channel.values(MPI_COMM_SELF).front() / expected, 1, 1e-6);
}

/// Fluid that a force accelerates as one has no strain, though its populations' stress has u F in it.
TEST(Quantities, NoDissipationInFreeAcceleration) {
  const double force = 1e-4, viscosity = 1. / 6;
  const auto box = wet_scene("size = [8, 8, 8]\nboundary = \"periodic\"",
                             "relaxation_time = 1\nbody_force = [1e-4, 0, 0]", "type = \"dissipation\"", 200);
  const double spurious = force * 200 * force * 3 / 2;  // the strain rate that u F would be taken for
  EXPECT_LT(box.values(MPI_COMM_SELF).front(), 1e-3 * 2 * viscosity * spurious * spurious);
}

/// Fluid that moves as one past a body that moves the same way, at other speeds: (u - V) of the cells
/// outside.
TEST(Quantities, SuperficialVelocity) {
  CaseText c = wet_scene("size = [32, 32, 32]\nboundary = \"periodic\"",
                         "relaxation_time = 1\ninitial = { type = \"uniform\", velocity = [0.02, 0, 0] }",
                         "type = \"superficial-velocity\"\naxis = \"x\"", 1);
  EXPECT_NEAR(value_of(c), 0.02, 1e-12);
  c.shapes = CaseText().shapes;
  c.bodies = body_of("ball", 1, "motion = \"prescribed\"\nvelocity = [0.02, 0, 0]");
  c.bodies += "position = [16, 16, 16]\n";
  EXPECT_NEAR(value_of(c), 0, 1e-6) << "no relative motion";
  c.fluid = "[fluid]\nprecision = \"double\"\nrelaxation_time = 1\n";
  const double solid = 4. / 3 * std::numbers::pi * 64 / (32. * 32 * 32);  // u is 0 but next to the body
  EXPECT_NEAR(value_of(c) / (-0.02 * (1 - solid)), 1, 0.01);
}

/// All momentum that fluid and body lose goes to the walls, from the first step on.
void expect_walls_get_what_is_lost(const std::string& lubrication, const std::string& shape) {
  CaseText c;
  c.domain = domain_of({12, 12, 16}, R"({ x = "periodic", y = "periodic", z = "no-slip" })");
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nprecision = \"double\"\n";
  c.shapes = shape;
  c.bodies = body_of("body", 3,
                     "position = [6, 6, 3.3]\nvelocity = [0.02, 0, -0.03]\nangular_velocity = [0, 0.01, 0]");
  c.rest =
      "[coupling]\nforce = \"exact\"\nlubrication = " + lubrication + "\n[contacts]\nrestitution = 0.9\n";
  c.run = "[run]\nsteps = 60\n";
  for (const char* side : {"z-low", "z-high"})
    for (const char* axis : {"x", "z"})
      c.run += fmt::format("[[quantities]]\nname = \"{0}{1}\"\ntype = \"wall-stress\"\nside = \"{0}\"\n",
                           side, axis) +
               fmt::format("axis = \"{}\"\ntime = 1\n", axis);
  Simulation s = c.start(MPI_COMM_WORLD);
  Quantities quantities(s.setup());
  const Vec3 start = s.balance().momentum;
  quantities.observe(s);
  for (int t = 1; t <= 60; ++t) {
    s.step();
    quantities.observe(s);
  }
  const std::vector<double> stress = numbers(quantities.evaluate(s));
  const Vec3 lost = start - s.balance().momentum;
  const double impulse = 12 * 12 * 60;
  EXPECT_GT(std::abs(lost[0]), 0.1);
  EXPECT_NEAR(impulse * (stress[0] + stress[2]), lost[0], 1e-9 * std::abs(lost[0]));
  EXPECT_NEAR(impulse * (stress[1] + stress[3]), lost[2], 1e-9 * std::abs(lost[2]));
}

/// Walls get momentum by the fluid, by contacts, and by the film, against rolling too: of a ball, and of a
/// body of which one part has a film and another one touches the floor beside it.
TEST(Quantities, WallsGetTheMomentumThatIsLostInAFilm) {
  expect_walls_get_what_is_lost("true", sphere_of("body", 6));
  expect_walls_get_what_is_lost(
      "true", shape_of("body", "compound",
                       "parts = [{ type = \"sphere\", diameter = 5.4, position = [-1, 0, 0] },\n"
                       "{ type = \"box\", edges = [3, 4, 5.6], position = [1.5, 0, 0] }]"));
}

/// Walls get momentum by what the impact does to the fluid around the ball, too.
TEST(Quantities, WallsGetTheMomentumThatIsLostInAnImpact) {
  expect_walls_get_what_is_lost("false", sphere_of("body", 6));
}

}  // namespace
}  // namespace silt::testing

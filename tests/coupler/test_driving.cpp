// What drives fluid and bodies, controlled or changing over time, flows that a run begins with, and bodies
// that move as given: against theory.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "rigid/bodies/prescribed_motion.hpp"
#include "silt/case/case.hpp"
#include "silt/simulation.hpp"
#include "tests/coupler/single_cells.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/silt/coupled_scenes.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

using std::numbers::e;
using std::numbers::pi;

constexpr double channel_viscosity = 0.1;

/// A channel along x, walls across y; half-way walls are exact for a parabola there.
CaseText channel(int height, const std::string& fluid,
                 const std::string& sides = R"(["no-slip", "no-slip"])") {
  CaseText c;
  c.domain = domain_of({4, height, 4}, "{ x = \"periodic\", y = " + sides + ", z = \"periodic\" }");
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nmagic = 0.1875\nprecision = \"double\"\n" + fluid;
  c.shapes = c.bodies = "";
  return c;
}

/// The velocity along x of a layer of cells across y, on one rank.
double along_x(const Simulation& simulation, int layer) {
  const FluidFields& fields = simulation.scene().flow->fields();
  return velocity(fields, 0, {1, layer, 1})[0];
}

double pressure(const Simulation& simulation, const lbm::Int3& cell) {
  lbm::MomentArrays moments;
  simulation.scene().flow->fields().moments(0, {cell, {1, 1, 1}}, moments);
  return moments[0].density_deviation / 3;
}

TEST(Driving, AFlowRateHasTheForceOfPoiseuille) {
  constexpr int height = 20;
  constexpr double wanted = 0.02;
  CaseText c = channel(height, "superficial_velocity = [0.02, 0, 0]\n");
  c.domain = domain_of({4, height, 8}, R"({ x = "periodic", y = ["no-slip", "no-slip"], z = "periodic" })");
  Simulation simulation = c.start(MPI_COMM_WORLD);
  simulation.run(1600);
  const auto mean = [&] {
    const Flow& flow = *simulation.scene().flow;
    return flow.fields().velocity_sum(flow.totals())[0] / simulation.setup().volume();
  };
  EXPECT_NEAR(mean(), wanted, 1e-4 * wanted) << "four times the time of the slowest mode";
  simulation.run(6400);
  const double theory =
      wanted * 24 * channel_viscosity / (2 * height * height + 1);  // a parabola in middles of cells
  EXPECT_NEAR(simulation.scene().flow->fields().spec().force[0], theory, 1e-8 * theory);
  EXPECT_NEAR(mean(), wanted, 1e-9 * wanted);
}

/// A flow through an array of spheres takes the same force whether the force or its rate is given.
TEST(Driving, AFlowRateThroughSpheresHasTheirDrag) {
  CaseText c = sphere_array();
  c.run =
      "[run]\nsteps = 3000\n[[quantities]]\nname = \"u\"\ntype = \"superficial-velocity\"\naxis = \"x\"\n"
      "[[quantities]]\nname = \"d\"\ntype = \"drag-coefficient\"\naxis = "
      "\"x\"\n"
      "[[quantities]]\nname = \"f\"\ntype = \"body-force\"\naxis = \"x\"\n";
  const auto driven = c.values(MPI_COMM_WORLD);
  EXPECT_EQ(driven[2], array_force);
  c.fluid = fmt::format(
      "[fluid]\nrelaxation_time = 1.0\nprecision = \"double\"\nsuperficial_velocity = [{:.17g}, 0, 0]\n",
      driven[0]);
  const auto controlled = c.values(MPI_COMM_WORLD);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(controlled[k], driven[k], 1e-5 * driven[k]) << k;
}

/// A share of 1 for all time changes no bit, beside walls, edges and bodies.
TEST(Driving, WhatChangesByNothingIsSteady) {
  const auto hash = [](const std::string& over_time) {
    CaseText c = crowd();
    const std::string moving = "{ type = \"moving\", velocity = ";
    c.domain =
        domain_of({24, 20, 28}, "{ x = [" + moving + "[0, 0.03, 0.01]" + over_time +
                                    " }, \"no-slip\"], y = [\"no-slip\", " + moving + "[0.02, 0, 0.01]" +
                                    over_time + " }], z = [\"no-slip\", \"no-slip\"] }");
    c.fluid += "body_force = [1e-5, 2e-5, 0]\nbody_force_on_bodies = true\n";
    if (!over_time.empty()) c.fluid += "body_force_over_time = { table = [[0, 1]] }\n";
    Simulation simulation = c.start(MPI_COMM_WORLD);
    simulation.run(30);
    return simulation.hash();
  };
  EXPECT_EQ(hash(", over_time = { table = [[0, 1]] }"), hash(""));
}

/// J. R. Womersley, J. Physiol. 127 (1955) 553; between plates: u = Re A / (i w) (1 - cosh(k y) / cosh(k h)).
TEST(Driving, AnOscillatingForceGivesTheFlowOfWomersley) {
  constexpr int height = 24;
  constexpr double amplitude = 2e-5, frequency = 1. / 800;
  using Complex = std::complex<double>;
  const Complex iw(0, 2 * std::numbers::pi * frequency), k = std::sqrt(iw / channel_viscosity);
  const CaseText c = channel(height, fmt::format("body_force = [{}, 0, 0]\nbody_force_over_time = {{ table = "
                                                 "[[0, 0]], amplitude = 1, frequency = {} }}\n",
                                                 amplitude, frequency));
  tests::alone([&] {
    Simulation simulation = c.start(MPI_COMM_SELF);
    simulation.run(6400);
    double error = 0, largest = 0;
    for (int i = 0; i < 800; i += 50) {
      simulation.run(50);
      const double t = double(simulation.steps_done());
      for (int y = 0; y < height; ++y) {
        const Complex profile = 1. - std::cosh(k * (y + 0.5 - height / 2)) / std::cosh(k * (height / 2.));
        const double exact = std::imag(amplitude / iw * profile * std::exp(iw * t));
        error = std::max(error, std::abs(along_x(simulation, y) - exact));
        largest = std::max(largest, std::abs(exact));
      }
    }
    EXPECT_LT(error, 2e-3 * largest);
    return 0;
  });
}

/// A wall that starts to move with a constant acceleration a drags fluid: u = 4 a t i2erfc(y / sqrt(4 nu t))
/// (H. Schlichting, Boundary-Layer Theory, chapter V).
TEST(Driving, AWallThatSpeedsUpDragsTheFluidAsTheorySays) {
  constexpr int steps = 1000, height = 60;
  constexpr double speed = 0.05;
  const CaseText c = channel(height, "",
                             "[{ type = \"moving\", velocity = [0.05, 0, 0], over_time = { table = [[0, 0], "
                             "[1000, 1]] } }, \"no-slip\"]");
  tests::alone([&] {
    Simulation simulation = c.start(MPI_COMM_SELF);
    simulation.run(steps);
    for (int y = 0; y < 30; ++y) {
      const double eta = (y + 0.5) / std::sqrt(4 * channel_viscosity * steps);
      const double shape =
          (1 + 2 * eta * eta) * std::erfc(eta) - 2 / std::sqrt(std::numbers::pi) * eta * std::exp(-eta * eta);
      EXPECT_NEAR(along_x(simulation, y), speed * shape, 1e-4 * speed) << y;
    }
    return 0;
  });
}

/// Water between plates 12 mm apart, a pressure of 2 uPa held at one end and none at the other, in SI: the
/// mean velocity is h^2 / (12 mu) times the gradient, 2 uPa over 39 mm, between the middles of the first and
/// the last cells, where an outlet holds its pressure.
TEST(Driving, PressuresAtTwoEndsDriveTheFlowOfPoiseuille) {
  constexpr double height = 0.012, viscosity = 1e-3;
  CaseText c;
  c.units = "[units]\nsystem = \"si\"\ncell_size = 1e-3\nrelaxation_time = 0.8\n";
  c.domain =
      "[domain]\nsize = [0.04, 0.012, 0.004]\nboundary = { x = [{ type = \"pressure-outlet\", pressure = "
      "2e-6 "
      "}, \"pressure-outlet\"], y = \"no-slip\", z = \"periodic\" }\n";
  c.fluid = "[fluid]\ndensity = 1000\ndynamic_viscosity = 1e-3\nmagic = 0.1875\nprecision = \"double\"\n";
  c.shapes = c.bodies = "";
  c.run =
      "[run]\nsteps = 6000\n[[quantities]]\nname = \"u\"\ntype = \"superficial-velocity\"\naxis = \"x\"\n";
  const double gradient = 2e-6 / 0.039, theory = gradient * height * height / (12 * viscosity);
  EXPECT_NEAR(c.values(MPI_COMM_WORLD)[0], theory, 0.01 * theory);
}

/// Fluid that comes in faster and faster pushes all before it: the pressure falls by L du/dt.
TEST(Driving, AnInletThatSpeedsUpHasThePressureOfTheoryBehindIt) {
  constexpr int length = 40, steps = 1500,
                waves = 1108;  // four times that of sound in four lengths
  CaseText c;
  c.domain = domain_of({length, 4, 4},
                       "{ x = [{ type = \"velocity-inlet\", velocity = [0.05, 0, 0], solid_for_bodies = "
                       "false, over_time = { table = [[0, 0], [4000, 1]] } }, { type = \"pressure-outlet\", "
                       "solid_for_bodies = false }], y = [\"free-slip\", \"free-slip\"], z = \"periodic\" }");
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nprecision = \"double\"\n";
  c.shapes = c.bodies = "";
  tests::alone([&] {
    Simulation simulation = c.start(MPI_COMM_SELF);
    simulation.run(steps);
    const FluidFields& fields = simulation.scene().flow->fields();
    const double gain = 0.05 / 4000;
    double lag = 0, difference = 0;
    for (int i = 0; i < waves; ++i) {
      simulation.step();
      lag += (gain * double(simulation.steps_done()) - velocity(fields, 0, {20, 1, 1})[0]) / waves;
      difference += (pressure(simulation, {10, 1, 1}) - pressure(simulation, {30, 1, 1})) / waves;
    }
    EXPECT_NEAR(lag, 0, 2e-3 * 0.025);
    EXPECT_NEAR(difference, gain * 20, 0.01 * gain * 20);
    return 0;
  });
}

/// Returns the largest velocity across a noisy stream, over the stream's, at the end.
double across_stream(double viscosity) {
  CaseText c;
  c.shapes = c.bodies = "";
  c.domain = domain_of({24, 8, 8},
                       "{ x = [{ type = \"velocity-inlet\", velocity = [0.08, 0, 0] }, "
                       "\"pressure-outlet\"], y = \"periodic\", z = \"periodic\" }");
  c.fluid = fmt::format(
      "[fluid]\nkinematic_viscosity = {}\ncollision = \"regularised\"\n"
      "initial = {{ type = \"uniform\", velocity = [0.08, 0, 0], noise = 0.001 }}\n",
      viscosity);
  Simulation s = c.start(MPI_COMM_SELF);
  s.run(2000);
  double largest = 0;
  const FluidFields& fields = s.scene().flow->fields();
  for_each_cell(fields, [&](int b, lbm::Int3 cell, lbm::Int3) {
    largest = std::max(largest, velocity(fields, b, cell).tail<2>().norm() / 0.08);
  });
  return largest;
}

/// With anti-bounce-back velocities along the outlet grow to half of the stream's from u/nu = 20 on.
TEST(Driving, DisturbancesLeaveThroughAnOutletAtAnyViscosity) {
  for (const double u_over_nu : {2, 10, 20, 50, 500})
    EXPECT_LT(across_stream(0.08 / u_over_nu), 1e-3) << u_over_nu;
}

TEST(Driving, ABallFallsAsARampOfGravitySays) {
  CaseText c;
  c.fluid = "";
  c.domain = domain_of({32, 32, 32});
  c.rest = "[gravity]\nacceleration = [0, 0, -1e-5]\nover_time = { table = [[0, 0], [400, 1]] }\n";
  tests::alone([&] {
    Simulation simulation = c.start(MPI_COMM_SELF);
    simulation.run(400);
    EXPECT_NEAR(simulation.bodies().velocity[0][2], -1e-5 * 200, 1e-12);
    EXPECT_NEAR(simulation.bodies().position[0][2], 16 - 1e-5 * 400 * 400 / 6., 2e-5);
    simulation.run(100);
    EXPECT_NEAR(simulation.bodies().velocity[0][2], -1e-5 * 300, 1e-12);
    return 0;
  });
}

/// Where the body force stands for a pressure gradient, it takes a free ball of the fluid's density along
/// with the fluid.
TEST(BodyForce, OnBodiesMovesBallAndFluidAlike) {
  CaseText c;
  c.domain = "[domain]\nsize = [24, 24, 24]\nblocks = [12, 12, 12]\nboundary = \"periodic\"\n";
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nbody_force = [1e-5, 0, 0]\nbody_force_on_bodies = true\n";
  c.bodies = body_of("ball", 1, "position = [12.2, 11.9, 12]");
  Simulation simulation = c.start(MPI_COMM_WORLD);
  simulation.run(500);
  const auto& bodies = simulation.bodies();
  for (std::size_t row = 0; row < bodies.owned; ++row)
    EXPECT_NEAR(bodies.velocity[row][0], 500 * 1e-5, 2e-2 * 500 * 1e-5);
}

/// Fluid alone in a periodic box; quantities are its energy and dissipation at the start, and the dissipation
/// a step later: a stress that is not that of the flow changes within a step.
CaseText flow_of(const std::array<int, 3>& cells, const std::string& initial, double tau = 0.8) {
  CaseText c;
  c.domain = domain_of(cells);
  c.fluid = "[fluid]\nprecision = \"double\"\nrelaxation_time = " + std::to_string(tau) + "\ninitial = { " +
            initial + " }\n";
  c.shapes.clear();
  c.bodies.clear();
  c.run = "[run]\nsteps = 1\n";
  for (const char* what :
       {"\"kinetic-energy\"\ntime = 0", "\"dissipation\"\ntime = 0", "\"dissipation\"\ntime = 1"})
    c.run += "[[quantities]]\nname = \"q" + std::to_string(c.run.size()) + "\"\ntype = " + what + "\n";
  return c;
}

/// Over the plane: the mean of u.u/2 is s^2 e pi R^2 / 2 A, that of 2 nu S:S is nu times that of the
/// vorticity's square, 2 pi e s^2 / A. The tails that the box cuts off are e^-28 of it.
TEST(InitialFlow, VortexHasItsEnergyAndDissipation) {
  const double swirl = 0.02, radius = 6, viscosity = 0.1, area = 64 * 64;
  const auto found = flow_of({64, 64, 8}, "type = \"vortex\", velocity = [0, 0, 0], swirl = 0.02, radius = 6")
                         .values(MPI_COMM_WORLD);
  EXPECT_NEAR(found[0] / (swirl * swirl * e * pi * radius * radius / (2 * area)), 1, 1e-6);
  EXPECT_NEAR(found[1] / (viscosity * 2 * pi * e * swirl * swirl / area), 1, 1e-4);
  EXPECT_NEAR(found[2] / found[1], 1, 0.03);
}

/// Means over the layers' thickness d = H/s, of four half layers: that of
/// tanh^2 is 1 - 4 d/H, of sech^4 it is 4 . 2/3 d/H.
TEST(InitialFlow, ShearLayersHaveTheirEnergyAndDissipation) {
  const double speed = 0.05, steepness = 20, share = 0.05, viscosity = 0.1, height = 64;
  const auto found = flow_of({64, 64, 8}, "type = \"shear-layer\", velocity = [0.05, 0, 0], steepness = 20")
                         .values(MPI_COMM_WORLD);
  const double thickness = height / steepness, wave = share * speed, k = 2 * pi / 64;
  const double energy = speed * speed / 2 * (1 - 4 / steepness) + wave * wave / 4;
  const double shear = speed / thickness * speed / thickness * 8 / (3 * steepness) + wave * wave * k * k / 2;
  EXPECT_NEAR(found[0] / energy, 1, 1e-3);
  EXPECT_NEAR(found[1] / (viscosity * shear), 1, 1e-3);
  EXPECT_NEAR(found[2] / found[1], 1, 0.06);
}

/// The fluid's force on a sphere that oscillates in fluid at rest (L. D. Landau, E. M. Lifshitz, Fluid
/// Mechanics, paragraph 24): F = -6 pi mu a (1 + a/d) u - 2/3 pi a^3 rho (1 + 9 d / (2 a)) du/dt, with the
/// penetration depth d = sqrt(2 nu / w).
TEST(PrescribedBodies, AnOscillatingSphereFeelsDragAndAddedMassAsTheorySays) {
  constexpr double a = 5, nu = 0.05, depth = 2.5, amplitude = 0.2;
  const double w = 2 * nu / (depth * depth);
  CaseText c;
  c.domain = domain_of({56, 56, 56}, "\"no-slip\"");
  c.fluid = "[fluid]\nkinematic_viscosity = 0.05\n";
  c.shapes = sphere_of("ball", 2 * a);
  c.bodies = body_of(
      "ball", 1,
      fmt::format("position = [28, 28, 28]\nmotion = {{ amplitude = [{}, 0, 0], frequency = {:.17g} }}",
                  amplitude, w / (2 * pi)));
  Simulation simulation = c.start(MPI_COMM_WORLD);
  const int period = int(std::lround(2 * pi / w));
  simulation.run(period + period / 2);
  double in_phase = 0, before_it = 0;  // of the velocity
  for (int i = 0; i < period; ++i) {
    simulation.step();
    double force = 0;
    for (const BodyLoad& load : simulation.last_loads()) force += load.force[0];
    force = tests::sum_over_ranks(force);
    const double phase = w * (double(simulation.steps_done()) - 0.5);
    in_phase += 2. / period * force * std::cos(phase);
    before_it += 2. / period * force * std::sin(phase);
  }
  const double u = amplitude * w;
  const double drag = -6 * pi * nu * a * (1 + a / depth) * u;
  const double added = 2. / 3 * pi * a * a * a * (1 + 4.5 * depth / a) * u * w;
  EXPECT_NEAR(in_phase, drag, 0.05 * std::abs(drag));
  EXPECT_NEAR(before_it, added, 0.05 * added);
}

/// A free sphere all of whose axes are locked feels what a fixed one does.
TEST(PrescribedBodies, ALockedSphereHasTheForceOfAFixedOne) {
  const auto force = [](const std::string& motion) {
    CaseText c = sphere_array();
    c.bodies = body_of("sphere", 1.5, "position = [8.2, 7.9, 8.1]\n" + motion);
    c.run = "[run]\nsteps = 5000\n[[quantities]]\nname = \"f\"\ntype = \"fluid-force\"\naxis = \"x\"\n";
    return c.values(MPI_COMM_WORLD)[0];
  };
  const double fixed = force("motion = \"fixed\"");
  EXPECT_GT(fixed, 1e-6);
  EXPECT_NEAR(force("locked = [\"x\", \"y\", \"z\", \"rotation x\", \"rotation y\", \"rotation z\"]"), fixed,
              1e-7 * fixed);
}

}  // namespace
}  // namespace silt::coupler::testing

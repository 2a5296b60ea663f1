// The figures of [[quantities]]: what each is worth in scenes whose answer is known, and that every one is
// the same to the bit on any number of ranks and across a checkpoint.
#include <fmt/format.h>
#include <mpi.h>

#include <bit>
#include <cmath>
#include <numbers>

#include "parallel/traffic.hpp"
#include "silt/case/case.hpp"
#include "silt/case/quantity_spec.hpp"
#include "silt/results/definitions.hpp"
#include "tests/coupler/case/case_text.hpp"
#include "tests/coupler/same_bits.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Vec3;
using tests::rank;

constexpr const char* finely_cut = "domain.blocks=[8, 16, 8]";  // 32 blocks

/// A dry scene of one quantity "q", periodic all round; balls of radius 4 and density 2.
CaseText dry(const std::string& bodies, const std::string& quantity, int steps = 100) {
  CaseText c;
  c.domain = domain_of({32, 32, 32});
  c.fluid.clear();
  c.bodies.clear();
  if (!bodies.empty()) c.bodies = body_of("ball", 2, "") + bodies + "\n";
  c.run = "[run]\nsteps = " + std::to_string(steps) + "\n[[quantities]]\nname = \"q\"\n" + quantity + "\n";
  return c;
}

std::vector<double> numbers(const std::vector<std::pair<std::string, double>>& named) {
  std::vector<double> values;
  for (const auto& [name, value] : named) values.push_back(value);
  return values;
}

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
  EXPECT_NEAR(value_of(dry(bodies, "type = \"displacement\"\naxis = \"x\"")), 25, 1e-12);
  EXPECT_NEAR(value_of(dry(bodies, "type = \"displacement\"\naxis = \"y\"")), 0, 1e-12);
  EXPECT_EQ(value_of(dry(bodies, "type = \"mean-velocity\"\naxis = \"x\"")), 0.25);
  EXPECT_EQ(value_of(dry(bodies, "type = \"momentum-change\"\naxis = \"x\"")), 0);
  EXPECT_NEAR(value_of(dry(bodies, "type = \"angular-momentum-change\"")), 0, 1e-14);
  EXPECT_EQ(value_of(dry(bodies, "type = \"energy-change\"")), 0);
}

TEST(Quantities, SpinOfAKind) {
  const std::string bodies =
      "name = \"top\"\nposition = [8, 8, 8]\nangular_velocity = [0, 0.01, 0]\n"
      "[[bodies]]\nshape = \"ball\"\ndensity = 2\nposition = [24, 24, 24]";
  const std::string spin = "type = \"mean-angular-velocity\"\naxis = \"y\"";
  EXPECT_EQ(value_of(dry(bodies, spin)), 0.005);
  EXPECT_EQ(value_of(dry(bodies, spin + "\nbody = \"top\"")), 0.01);
}

/// Falling freely from rest: E stays, v = g t, P gains m g t (but the scale, of rest, is 0: nothing to speak
/// of).
TEST(Quantities, FreeFall) {
  CaseText fall = dry("position = [16, 16, 30]", "type = \"energy-change\"", 50);
  fall.domain = domain_of({32, 32, 64}, R"("no-slip")");
  fall.rest = "[gravity]\nacceleration = [0, 0, -0.01]\n";
  EXPECT_NEAR(value_of(fall), 0, 1e-12);
  fall.run = dry("", "type = \"energy-growth\"", 50).run;
  EXPECT_NEAR(value_of(fall), 0, 1e-12);
  fall.run = dry("", "type = \"momentum-change\"", 50).run;
  EXPECT_TRUE(std::isnan(value_of(fall)));
  fall.run = dry("", "type = \"displacement\"", 50).run;
  EXPECT_NEAR(value_of(fall), -0.5 * 0.01 * 50 * 50, 1e-10);
}

/// A ball that stops dead (restitution 0) has lost its kinetic energy, all there is.
TEST(Quantities, EnergyLostInAnImpact) {
  CaseText c = dry("position = [16, 16, 16]\nvelocity = [0.5, 0, 0]", "type = \"energy-change\"");
  c.domain = domain_of({32, 32, 32}, R"("no-slip")");
  EXPECT_NEAR(value_of(c), -1, 1e-12);
  c.run = dry("", "type = \"energy-growth\"").run;
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
  EXPECT_NEAR(value_of(dry(balls, "type = \"packing-fraction\"\nbox = [[0, 0, 0], [32, 12, 4]]", 1)),
              std::numbers::pi / 6, 2e-3);
  EXPECT_NEAR(value_of(dry(balls, slab, 1)), disc, 2e-3);
  EXPECT_NEAR(value_of(dry(balls, "type = \"packing-fraction\"", 1)), 8 * (4. / 3 * std::numbers::pi) / 512,
              1e-14)
      << "bodies all inside";
}

/// The common part of two balls counts once, in a box all round them and in one that cuts them in the middle
/// of the line between them.
TEST(Quantities, PackingFractionOfACompound) {
  CaseText pair =
      dry("position = [20, 3, 16]\norientation = [0.9, 0.1, 0.3, 0.3]", "type = \"packing-fraction\"", 1);
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
  EXPECT_NEAR(value_of(dry(row, rate + "time = 0", 160)), 2 * mass / 160, 1e-9);
  EXPECT_NEAR(value_of(dry(row, rate + "time = 80", 160)), mass / 80, 1e-9);
}

/// A body at 30 degrees from straight down, turned about +y: towards -x.
TEST(Quantities, BedAngle) {
  CaseText c = dry("position = [12, 5, 9.0717967697244912]",
                   "type = \"bed-angle\"\naxis = \"y\"\ncentre = [16, 0, 16]\ntime = 0", 1);
  c.rest = "[gravity]\nacceleration = [0, 0, -1e-12]\n";
  EXPECT_NEAR(value_of(c), 30, 1e-8);
}

/// A weight 3 to the one side of the axis, and one of another kind, which is not asked for.
TEST(Quantities, WeightTorque) {
  CaseText c =
      dry("position = [13, 5, 9]\nname = \"asked\"",
          "type = \"weight-torque\"\nbody = \"asked\"\naxis = \"y\"\ncentre = [16, 0, 16]\ntime = 0", 1);
  c.bodies += body_of("ball", 1, "position = [25, 25, 25]");
  c.rest = "[gravity]\nacceleration = [0, 0, -1e-12]\n";
  const double volume = 4. / 3 * std::numbers::pi * 64;
  EXPECT_NEAR(value_of(c) / (-3 * volume * 2 * 1e-12), 1, 1e-9);
}

/// A scene of fluid alone with one quantity "q".
CaseText wet(const std::string& domain, const std::string& fluid, const std::string& quantity, int steps) {
  CaseText c = dry("", quantity, steps);
  c.domain = "[domain]\n" + domain + "\n";
  c.fluid = "[fluid]\nprecision = \"double\"\n" + fluid + "\n";
  c.shapes.clear();
  return c;
}

CaseText vortex(const std::string& quantity, int steps = 1) {
  return wet("size = [32, 32, 32]\nboundary = \"periodic\"",
             "relaxation_time = 0.8\ninitial = { type = \"taylor-green-3d\", velocity = [0.02, 0, 0] }",
             quantity, steps);
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
  const auto channel =
      wet("size = [8, 8, 8]\nboundary = { x = \"periodic\", y = \"periodic\", z = \"no-slip\" }",
          "relaxation_time = 1\nmagic = 0.1875\nbody_force = [1e-6, 0, 0]", "type = \"dissipation\"", 3000);
  const double expected = force * force * (height * height - 1) / (12 * viscosity);
  EXPECT_NEAR(channel.values(MPI_COMM_SELF).front() / expected, 1, 1e-6);
}

/// Fluid that a force accelerates as one has no strain, though its populations' stress has u F in it.
TEST(Quantities, NoDissipationInFreeAcceleration) {
  const double force = 1e-4, viscosity = 1. / 6;
  const auto box = wet("size = [8, 8, 8]\nboundary = \"periodic\"",
                       "relaxation_time = 1\nbody_force = [1e-4, 0, 0]", "type = \"dissipation\"", 200);
  const double spurious = force * 200 * force * 3 / 2;  // the strain rate that u F would be taken for
  EXPECT_LT(box.values(MPI_COMM_SELF).front(), 1e-3 * 2 * viscosity * spurious * spurious);
}

/// Fluid that moves as one past a body that moves the same way, at other speeds: (u - V) of the cells
/// outside.
TEST(Quantities, SuperficialVelocity) {
  CaseText c = wet("size = [32, 32, 32]\nboundary = \"periodic\"",
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

/// Every type that looks at bodies, in a crowd: the same bits on any number of ranks and blocks.
CaseText watched_crowd() {
  CaseText c = dry("", "type = \"drift\"", 150);
  c.domain = domain_of({32, 32, 32}, R"({ x = "periodic", y = "periodic", z = ["no-slip", "no-slip"] })");
  c.rest =
      "[gravity]\nacceleration = [1e-3, 0, -3e-3]\n[contacts]\nrestitution = 0.5\nfriction = 0.3\n"
      "[[walls]]\nname = \"pipe\"\ntype = \"tube\"\nradius = 15.9\naxis = \"x\"\npoint = [0, 16, 16]\n";
  c.shapes =
      "[[shapes]]\nname = \"ball\"\ntype = \"sphere\"\nradius = 2.2\n"
      "[[shapes]]\nname = \"brick\"\ntype = \"box\"\nedges = [2, 3, 4]\n";
  c.bodies =
      "[[fill]]\nshape = \"ball\"\ndensity = 2\ncount = 20\ngap = 0.1\n"
      "[[fill]]\nshape = \"brick\"\ndensity = 3\ncount = 20\ngap = 0.1\n";
  int n = 0;
  for (const QuantityType& type : quantity_types) {
    if (type.asks_for(QuantityType::fluid)) continue;
    c.run +=
        "[[quantities]]\nname = \"" + std::to_string(n++) + "\"\ntype = \"" + std::string(type.name) + "\"\n";
    if (type.takes(QuantityType::time)) c.run += "time = 60\n";
    if (type.takes(QuantityType::height)) c.run += "height = 9\n";
    if (type.takes(QuantityType::centre)) c.run += "centre = [16, 16, 16]\n";
    if (type.takes(QuantityType::axis)) c.run += "axis = \"x\"\n";
    if (type.takes(QuantityType::wall)) c.run += "wall = \"pipe\"\n";
    if (type.takes(QuantityType::component)) c.run += "component = \"xz\"\n";
  }
  return c;
}

void expect_same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    EXPECT_EQ(std::bit_cast<std::uint64_t>(a[i]), std::bit_cast<std::uint64_t>(b[i]))
        << "quantity " << i << ": " << a[i] << " and " << b[i];
}

TEST(Quantities, TheSameBitsOnAnyRanks) {
  const CaseText text = watched_crowd();
  expect_same_bits(text.values(MPI_COMM_SELF), text.values(MPI_COMM_WORLD, {finely_cut}));
}

TEST(Quantities, OfFluidTheSameBitsOnAnyRanks) {
  for (const char* type : {"kinetic-energy", "dissipation"}) {
    const CaseText text = vortex("type = \"" + std::string(type) + "\"", 20);
    expect_same_bits(text.values(MPI_COMM_SELF), text.values(MPI_COMM_WORLD, {finely_cut}));
  }
}

TEST(Quantities, GoOnFromACheckpoint) {
  Simulation simulation = watched_crowd().start(MPI_COMM_WORLD, {finely_cut});
  const Case& scene = simulation.setup();
  Quantities quantities(scene);
  quantities.observe(simulation);
  for (int i = 0; i < 90; ++i) {
    simulation.step();
    quantities.observe(simulation);
  }
  const Saved saved(simulation, quantities);
  const auto resumed = saved.go_on(scene);
  Quantities again(scene);
  again.set_history(read_history(saved.reader(), scene));
  const auto finish = [&](Simulation& s, Quantities& q) {
    while (s.steps_done() < 150) {
      s.step();
      q.observe(s);
    }
    return numbers(q.evaluate(s));
  };
  expect_same_bits(finish(*resumed, again), finish(simulation, quantities));
}

/// The quantities of a checkpoint that are read again for a case.
std::vector<bool> taken_up(const Saved& saved, const Case& setup) {
  std::vector<bool> taken;
  for (const QuantityHistory& h : read_history(saved.reader(), setup)) taken.push_back(h != no_history);
  return taken;
}

/// Each key of each accumulated quantity, changed alone: what was summed before is dropped, and that of no
/// other quantity; a warning names it. A name that another quantity had is no way to its sums.
TEST(Quantities, OfOtherDefinitionsBeginAnew) {
  using Q = QuantityType;
  const CaseText text = watched_crowd();
  Simulation simulation = text.start(MPI_COMM_WORLD, {finely_cut});
  const Case& scene = simulation.setup();
  Quantities quantities(scene);
  quantities.observe(simulation);
  for (int i = 0; i < 70; ++i) {
    simulation.step();
    quantities.observe(simulation);
  }
  const Saved saved(simulation, quantities);
  const std::vector<bool> before = taken_up(saved, scene);
  EXPECT_TRUE(begun_anew(saved.reader(), scene).empty());
  int changed = 0;
  const auto expect_anew = [&](std::size_t i, const std::string& name, const Overrides& overrides) {
    const Case other = text.read(overrides);
    std::vector<bool> after = before;
    after[i] = false;
    EXPECT_EQ(taken_up(saved, other), after) << overrides.front();
    const auto warnings = begun_anew(saved.reader(), other);
    const bool warns = computation_of(scene.quantities[i].type).gathers();
    ASSERT_EQ(warnings.size(), warns) << overrides.front();
    if (warns) {
      EXPECT_TEXT(warnings[0].text, "'" + name + "'");
    }
    ++changed;
  };
  for (std::size_t i = 0; i < scene.quantities.size(); ++i) {
    if (!before[i]) continue;
    const std::string name = scene.quantities[i].name;
    const QuantityType& type = quantity_type(scene.quantities[i].type);
    for (const auto& [key, value] : {std::pair(Q::axis, "axis=\"y\""),
                                     {Q::time, "time=61"},
                                     {Q::height, "height=10"},
                                     {Q::centre, "centre=[16, 15, 16]"},
                                     {Q::body, "body=\"brick\""}})
      if (type.takes(key)) expect_anew(i, name, {fmt::format("quantities[{}].{}", i, value)});
    expect_anew(i, "other", {fmt::format("quantities[{}].name=\"other\"", i)});
  }
  EXPECT_GT(changed, 30);
}

/// An instant that is over when a run goes on has no value, and not that of another one.
TEST(Quantities, AnInstantBeforeAResumeHasNoValue) {
  const CaseText text = vortex("type = \"kinetic-energy\"\ntime = 5", 12);
  Simulation simulation = text.start(MPI_COMM_WORLD);
  Quantities quantities(simulation.setup());
  for (int i = 0; i < 9; ++i) {
    simulation.step();
    quantities.observe(simulation);
  }
  const Saved saved(simulation, quantities);
  const auto value = [&](const char* time) {
    const Case scene = text.read({time});
    const auto again = saved.go_on(scene);
    Quantities resumed(scene);
    resumed.set_history(read_history(saved.reader(), scene));
    while (again->steps_done() < 12) {
      again->step();
      resumed.observe(*again);
    }
    return resumed.evaluate(*again).front().second;
  };
  EXPECT_EQ(value("quantities[0].time=5"), quantities.evaluate(simulation).front().second);
  EXPECT_TRUE(std::isnan(value("quantities[0].time=6")));
  EXPECT_EQ(value("quantities[0].time=11"),
            vortex("type = \"kinetic-energy\"\ntime = 11", 12).values(MPI_COMM_WORLD).front());
}

/// A ball in a sheared fluid beside two walls, and every quantity that looks at what the walls bear.
CaseText watched_shear() {
  CaseText c;
  c.domain =
      "[domain]\nsize = [16, 16, 32]\n[domain.boundary]\nx = \"periodic\"\ny = \"periodic\"\n"
      "z = [{ type = \"moving\", velocity = [-0.01, 0, 0] }, { type = \"moving\", velocity = [0.01, 0, 0] "
      "}]\n";
  c.bodies = body_of("ball", 2, "position = [8, 8, 5]");
  c.rest = "[gravity]\nacceleration = [0, 0, -1e-4]\n";
  c.run =
      "[run]\nsteps = 150\n"
      "[[quantities]]\nname = \"stress\"\ntype = \"wall-stress\"\nside = \"z-low\"\naxis = \"z\"\ntime = 20\n"
      "[[quantities]]\nname = \"viscosity\"\ntype = \"relative-viscosity\"\naxis = \"z\"\ntime = 0\n"
      "[[quantities]]\nname = \"energy\"\ntype = \"energy-growth\"\n";
  return c;
}

/// All momentum that fluid and ball lose goes to the walls.
void expect_walls_get_what_is_lost(const std::string& lubrication) {
  CaseText c;
  c.domain = domain_of({12, 12, 16}, R"({ x = "periodic", y = "periodic", z = "no-slip" })");
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nprecision = \"double\"\n";
  c.shapes = sphere_of("ball", 6);
  c.bodies = body_of("ball", 3,
                     "position = [6, 6, 3.3]\nvelocity = [0.02, 0, -0.03]\nangular_velocity = [0, 0.01, 0]");
  c.rest =
      "[coupling]\nforce = \"exact\"\nlubrication = " + lubrication + "\n[contacts]\nrestitution = 0.9\n";
  c.run = "[run]\nsteps = 60\n";
  for (const char* side : {"z-low", "z-high"})
    for (const char* axis : {"x", "z"})
      c.run += fmt::format("[[quantities]]\nname = \"{0}{1}\"\ntype = \"wall-stress\"\nside = \"{0}\"\n",
                           side, axis) +
               fmt::format("axis = \"{}\"\ntime = 2\n", axis);
  Simulation s = c.start(MPI_COMM_WORLD);
  Quantities quantities(s.setup());
  quantities.observe(s);
  Vec3 start = Vec3::Zero();
  for (int t = 1; t <= 60; ++t) {
    s.step();
    quantities.observe(s);
    if (t == 1) start = s.balance().momentum;
  }
  const std::vector<double> stress = numbers(quantities.evaluate(s));
  const Vec3 lost = start - s.balance().momentum;
  const double impulse = 12 * 12 * 59;
  EXPECT_GT(std::abs(lost[0]), 0.1);
  EXPECT_NEAR(impulse * (stress[0] + stress[2]), lost[0], 1e-9 * std::abs(lost[0]));
  EXPECT_NEAR(impulse * (stress[1] + stress[3]), lost[2], 1e-9 * std::abs(lost[2]));
}

/// Walls get momentum by the fluid, by contacts, and by the film, against rolling too.
TEST(Quantities, WallsGetTheMomentumThatIsLostInAFilm) {
  expect_walls_get_what_is_lost("true");
}
/// Walls get momentum by what the impact does to the fluid around the ball, too.
TEST(Quantities, WallsGetTheMomentumThatIsLostInAnImpact) {
  expect_walls_get_what_is_lost("false");
}

TEST(Quantities, OfWallsTheSameBitsOnAnyRanks) {
  const CaseText text = watched_shear();
  expect_same_bits(text.values(MPI_COMM_SELF), text.values(MPI_COMM_WORLD, {"domain.blocks=[1, 1, 8]"}));
}

/// No rank waits for another after a step: the sums of many steps are put together while the run goes on, and
/// give the same bits as when every step is summed at once.
TEST(Quantities, ObservedWithoutWaiting) {
  for (const CaseText& text : {watched_crowd(), watched_shear()}) {
    constexpr int steps = 150;
    const auto observed = [&](bool at_once) {
      Simulation simulation = text.start(MPI_COMM_WORLD);
      Quantities quantities(simulation.setup());
      parallel::Traffic sent;
      for (int i = 0; i <= steps; ++i) {
        if (i > 0) simulation.step();
        const parallel::Traffic before = parallel::traffic();
        parallel::begin_step_of_traffic();
        quantities.observe(simulation);
        sent += parallel::traffic() - before;
        if (at_once) quantities.history(simulation);
      }
      if (!at_once) {
        EXPECT_LE(sent.blocking_collectives, 2u) << "outflow-rate asks the counters, once in a run";
        EXPECT_EQ(sent.messages, 0u);
        const std::uint64_t started = (steps + 1) / Quantities::most_steps;
        EXPECT_EQ(sent.collectives_under_way, tests::ranks() > 1 ? started - 1 : 0u)
            << "the last is not over";
      }
      return numbers(quantities.evaluate(simulation));
    };
    expect_same_bits(observed(true), observed(false));
  }
}

}  // namespace
}  // namespace silt::coupler::testing

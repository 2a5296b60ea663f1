// Springs and dampers between bodies, and to points, against theory.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "silt/case/case.hpp"
#include "silt/simulation.hpp"
#include "tests/coupler/forces/spring_scenes.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Vec3;

const double ball_volume = 4 * std::numbers::pi / 3 * 64;  // of a ball of radius 4

/// m x'' + c x' + k x = 0 from rest at 3: x = 3 exp(-g t) (cos w t + g / w sin w t).
TEST(Springs, AMassOnADampedSpringSwingsAndDecaysAsTheorySays) {
  const double mass = 1.2 * ball_volume, k = 1e-3 * mass, damping = 4e-3 * mass;
  const CaseText c =
      dry(body_of("ball", 1.2, "position = [35, 32, 32]"),
          fmt::format("[[springs]]\nbody = \"ball\"\nends = [[35, 32, 32], [12, 32, 32]]\nlength = 20\n"
                      "stiffness = {}\ndamping = {}\n",
                      k, damping));
  tests::alone([&] {
    Simulation simulation = c.start(MPI_COMM_SELF);
    const double g = damping / mass / 2, w = std::sqrt(k / mass - g * g);
    for (int n = 0; n < 20; ++n) {
      simulation.run(50);
      const double t = double(simulation.steps_done());
      const double x = 3 * std::exp(-g * t) * (std::cos(w * t) + g / w * std::sin(w * t));
      EXPECT_NEAR(simulation.bodies().position[0][0], 32 + x, 3 * 2e-3)
          << t << ": of the second order in the frequency, 0.032 a step";
    }
    EXPECT_EQ(simulation.bodies().position[0][1], 32);
    return 0;
  });
}

/// d/dt w = -c K w: the speed at which two bodies part falls by e^(-c K) in a step, and never turns round.
TEST(Springs, ADamperSlowsDownAndNeverTurnsRound) {
  constexpr double start = 0.05;
  for (const double decay : {1e-3, 1e-2, 0.1, 1., 20., 200., 1e4, 1e9}) {
    const CaseText c =
        dry(body_of("ball", 1.2, "name = \"a\"\nposition = [32, 32, 44]\nvelocity = [0, 0, 0.05]") +
                body_of("ball", 1.2, "name = \"b\"\nposition = [32, 32, 20]"),
            fmt::format("[[springs]]\nbody = \"a\"\nto = \"b\"\nstiffness = 0\ndamping = {}\n",
                        decay * 1.2 * ball_volume / 2));
    tests::alone([&] {
      Simulation simulation = c.start(MPI_COMM_SELF);
      double before = start;
      for (int step = 0; step < 10; ++step) {
        simulation.step();
        const rigid::BodySet& bodies = simulation.bodies();
        const double speed = bodies.velocity[0][2] - bodies.velocity[1][2];
        EXPECT_GE(speed, -1e-15 * start) << decay;
        EXPECT_LE(speed, before / (1 + std::min(decay, 1e4)) + 1e-15 * start) << decay;
        EXPECT_NEAR(speed, before * std::exp(-decay), before * 0.4 * std::min(1.0, decay * decay * decay));
        before = speed;
      }
      return 0;
    });
  }
}

/// A body that hangs on a damper sinks as fast as its weight over c; one that rests on a floor is carried by
/// the floor alone.
TEST(Springs, ADamperCarriesAWeightThatSinksAndNoneThatRests) {
  constexpr double gravity = 1e-5;
  const double mass = 1.2 * ball_volume;
  for (const double decay : {0.05, 1., 20., 1e3})
    for (const bool rests : {false, true}) {
      CaseText c = dry(body_of("ball", 1.2, fmt::format("position = [32, 32, {}]", rests ? 4 : 40)),
                       fmt::format("[gravity]\nacceleration = [0, 0, -{}]\n[[springs]]\nbody = "
                                   "\"ball\"\nends = [[32, 32, 40], [32, 32, 60]]\nstiffness = 0\ndamping = "
                                   "{}\n",
                                   gravity, decay * mass));
      c.domain = domain_of({64, 64, 64}, "{ x = \"periodic\", y = \"periodic\", z = \"no-slip\" }");
      c.run =
          "[run]\nsteps = 600\n[[quantities]]\nname = \"floor\"\ntype = \"contact-force\"\nside = "
          "\"z-low\"\naxis = \"z\"\n";
      tests::alone([&] {
        Simulation simulation = c.start(MPI_COMM_SELF);
        const double on_floor = values_of(simulation)[0], speed = simulation.bodies().velocity[0][2];
        EXPECT_NEAR(on_floor, rests ? -mass * gravity : 0, 1e-9 * mass * gravity) << decay;
        EXPECT_NEAR(speed, rests ? 0 : -gravity / decay, 1e-9 * gravity / decay) << decay;
        return 0;
      });
    }
}

/// Kinetic energy, and that of the springs.
double energy_of(const Simulation& simulation) {
  const rigid::BodySet& bodies = simulation.bodies();
  double energy = 0;
  for (std::size_t row = 0; row < bodies.owned; ++row) energy += bodies.kinetic_energy(row);
  const auto at = [&](rigid::BodyId id, const Vec3& arm) -> Vec3 {
    return id == 0 ? arm : bodies.pose(bodies.row_of(id)).to_world(arm);
  };
  const rigid::Extent extent = extent_of(simulation.setup());
  for (const SpringSpec& s : simulation.setup().springs) {
    const Vec3 apart = nearest_image(at(s.to, s.to_arm) - at(s.body, s.arm), extent);
    energy += 0.5 * s.stiffness * std::pow(apart.norm() - s.length, 2);
  }
  return energy;
}

/// Bodies, a fixed one among them, that are tied to each other and to the domain; with a
/// damper of any strength where asked for. The lengths are those of the start, or 0.
CaseText tied_at_random(unsigned seed, bool damped) {
  std::mt19937 random(seed);
  const auto any = [&](double low, double high) {
    return std::uniform_real_distribution<>(low, high)(random);
  };
  const auto point = [&](double size) {
    return fmt::format("[{}, {}, {}]", any(-size, size), any(-size, size), any(-size, size));
  };
  CaseText c = dry("", "");
  c.shapes = shape_of("brick", "box", "edges = [6, 4, 2]");
  const int count = 2 + int(random() % 6);
  std::vector<Vec3> places;
  for (int k = 0; k < count; ++k) {
    places.emplace_back(any(20, 44), any(20, 44), 8 + 48. * k / count);
    c.bodies += body_of(
        "brick", any(1, 4),
        fmt::format("name = \"b{}\"\nposition = [{}, {}, {}]\n", k, places[k][0], places[k][1],
                    places[k][2]) +
            (k == 1 ? "motion = \"fixed\"\n"
                    : fmt::format("velocity = {}\nangular_velocity = {}\n", point(0.01), point(0.003))));
  }
  for (int k = 0; k < 6 * count; ++k) {
    const int a = int(random() % unsigned(count)), b = int(random() % unsigned(count + 2));
    if (a == b || (a == 1 && b >= count)) continue;
    const auto end = [&](const Vec3& at) {
      return fmt::format("[{}, {}, {}]", at[0] + any(-2, 2), at[1] + any(-2, 2), at[2] + any(-1, 1));
    };
    c.rest += fmt::format("[[springs]]\nbody = \"b{}\"\n", a);
    if (b < count) c.rest += fmt::format("to = \"b{}\"\n", b);
    const bool hinged = random() % 4 == 0;
    const std::string here = end(places[a]);
    c.rest += fmt::format("ends = [{}, {}]\nstiffness = {}\ndamping = {}\n{}", here,
                          hinged ? here : end(places[b < count ? b : a]), any(0, 0.1),
                          damped ? std::pow(10, any(-2, 6)) : 0.0, hinged ? "length = 0\n" : "");
  }
  c.rest += "[contacts]\nrestitution = 0\n";
  return c;
}

/// Leapfrog's energy swings a little; with dampers it falls, but for that.
TEST(Springs, NoneOfManyMakesEnergy) {
  for (const bool damped : {false, true})
    for (unsigned seed = 0; seed < 10; ++seed) {
      tests::alone([&] {
        Simulation simulation = tied_at_random(seed, damped).start(MPI_COMM_SELF);
        const double first = energy_of(simulation);
        double least = first, last = first, rise = 0;
        for (int step = 0; step < 2000; ++step) {
          simulation.step();
          last = energy_of(simulation);
          least = std::min(least, last);
          rise = std::max(rise, last - (damped ? least : first));
        }
        EXPECT_LT(rise, 4e-3 * first) << damped << " " << seed;
        EXPECT_LT(last, damped ? 0.2 * first : first);
        return 0;
      });
    }
}

TEST(Springs, TwoBodiesSwingAboutTheirCentre) {
  const double reduced = 0.8 * ball_volume, k = 4e-4 * reduced, distance = std::hypot(14, 4);
  Simulation simulation = two_balls(k).start(MPI_COMM_WORLD);
  const double w = std::sqrt(k / reduced);
  const int steps = int(std::lround(7.5 * 2 * std::numbers::pi / w));
  const auto place = [&](int id) {
    const std::size_t row = simulation.bodies().row_of(rigid::BodyId(id));
    const bool own = row < simulation.bodies().owned;
    Vec3 x;
    for (int d = 0; d < 3; ++d)
      x[d] = tests::sum_over_ranks(
          own ? simulation.bodies().position[row][d] + 64 * simulation.bodies().image[row][d] : 0);
    return x;
  };
  simulation.run(steps);
  const Vec3 a = place(1), b = place(2);
  EXPECT_NEAR((b - a + Vec3(64, 0, 0)).norm(), 12 + (distance - 12) * std::cos(w * steps),
              2e-3 * (distance - 12));
  EXPECT_LT((a + 2 * b - Vec3(60 + 20, 30 + 68, 96)).norm(), 1e-9) << "the centre of mass";
}

/// A rod of length 16 that hangs from an axis through its end, held there by two springs without a length:
/// w^2 = m g s / (I + m s^2) for small angles.
TEST(Springs, TwoOfNoLengthAreAHinge) {
  constexpr double arm = 8, start = 0.05, gravity = 2e-5;
  const double mass = 2 * 16 * 4 * 4, moment = mass * (16 * 16 + 4 * 4) / 12.;
  const Vec3 hinge(32, 32, 40);
  const Vec3 centre = hinge + arm * Vec3(std::sin(start), 0, -std::cos(start));
  std::string springs = fmt::format("[gravity]\nacceleration = [0, 0, -{}]\n", gravity);
  for (const double y : {30., 34.})
    springs += fmt::format(
        "[[springs]]\nbody = \"rod\"\nends = [[32, {}, 40], [32, {}, 40]]\nlength = 0\nstiffness = {}\n", y,
        y, 0.02 * mass);
  CaseText c =
      dry(body_of("rod", 2,
                  fmt::format("position = [{}, {}, {}]\norientation = {{ axis = [0, 1, 0], degrees = {} }}",
                              centre[0], centre[1], centre[2], -start * 180 / std::numbers::pi)),
          springs);
  c.shapes = shape_of("rod", "box", "edges = [4, 4, 16]");
  tests::alone([&] {
    Simulation simulation = c.start(MPI_COMM_SELF);
    const double w = std::sqrt(mass * gravity * arm / (moment + mass * arm * arm));
    const double period = 2 * std::numbers::pi / w * (1 + start * start / 16);
    double largest = 0, crossed = 0, before = 0;
    int crossings = 0;
    for (int i = 0; i < int(2.6 * period); ++i) {
      simulation.step();
      const rigid::Pose pose = simulation.bodies().pose(0);
      largest = std::max(largest, (pose.to_world({0, 0, arm}) - hinge).norm());
      const double x = pose.position[0] - 32;
      if (i > 0 && before * x < 0) crossed = i + before / (before - x), ++crossings;
      before = x;
    }
    EXPECT_EQ(crossings, 5);
    EXPECT_NEAR(crossed, 2.25 * period, 5e-3 * period);
    EXPECT_LT(largest, 5e-3) << "g over the square of its frequency, 0.14 a step";
    EXPECT_LT(simulation.bodies().angular_velocity[0].cross(Vec3::UnitY()).norm(), 1e-9)
        << "about the axis alone";
    return 0;
  });
}

/// The force of the fluid on a ball that a spring holds is told without the spring.
TEST(Springs, AreNoForceOfTheFluid) {
  CaseText c;
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nbody_force = [1e-5, 0, 0]\n";
  c.rest =
      "[[springs]]\nbody = \"ball\"\nends = [[16, 16, 16], [16, 16, 16]]\nstiffness = 10\ndamping = 30\n";
  c.run =
      "[run]\nsteps = 4000\n[[quantities]]\nname = \"f\"\ntype = \"fluid-force\"\naxis = \"x\"\n"
      "[[quantities]]\nname = \"x\"\ntype = \"displacement\"\naxis = \"x\"\n";
  const auto values = c.values(MPI_COMM_WORLD);
  EXPECT_GT(values[0], 0.01);
  EXPECT_NEAR(values[0], 10 * values[1], 1e-3 * values[0]) << "the spring holds it against the fluid";
}

}  // namespace
}  // namespace silt::coupler::testing

// Cohesion, and the attraction of van der Waals, against theory.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "rigid/math/types.hpp"
#include "tests/rigid/response/flat_grounds.hpp"

namespace silt::rigid::testing {
namespace {

/// A chain of balls hangs from one that is fixed.
TEST(Cohesion, AChainHoldsUpToItsLoad) {
  constexpr int links = 5;
  for (const double load : {0.99, 1.01}) {
    Scene s(0, 0.3);
    s.world.materials[0].cohesion = links * g / load;
    s.world.gravity = Vec3(0, 0, -g);
    const int ball = s.shape(Sphere{ball_radius});
    for (int i = 0; i <= links; ++i) s.add(ball, Vec3(50, 50, 50 - 2 * ball_radius * i));
    s.bodies.motion[0] = Motion::fixed;
    s.settings.max_sweeps = 64;
    s.start();
    s.run(500, time_step);
    const double fallen = 50 - 2 * ball_radius * links - s.x(links)[2];
    if (load < 1)
      EXPECT_LT(fallen, 1e-6);
    else
      EXPECT_NEAR(fallen, 0, 1.3);
    EXPECT_EQ(fallen > 0.01, load > 1) << load;
  }
}

/// Balls that touch and turn about their common centre, by an angle a step: a chain, or a ring.
struct Wheel {
  std::vector<Vec3> places;  // from the centre
  double tension;            // of the most loaded contact, for balls of mass 1 that turn by 1 a second
};

Wheel chain_of(int balls) {
  Wheel chain{{}, 0};
  for (int i = 0; i < balls; ++i) chain.places.emplace_back((2 * i - balls + 1) * ball_radius, 0, 0);
  for (const Vec3& x : chain.places) chain.tension += std::max(0.0, x[0]);
  return chain;
}

Wheel ring_of(int balls) {
  const double half = std::numbers::pi / balls, radius = ball_radius / std::sin(half);
  Wheel ring{{}, radius / (2 * std::sin(half))};
  for (int i = 0; i < balls; ++i)
    ring.places.emplace_back(radius * std::cos(2 * i * half), radius * std::sin(2 * i * half), 0);
  return ring;
}

/// The widest gap between balls that touched, relative to their size.
double widest_gap(const Scene& s, int balls, bool closed) {
  double widest = -1;
  for (int i = 0; i + !closed < balls; ++i) {
    Vec3 apart = s.x((i + 1) % balls) - s.x(i);
    for (int d = 0; d < 3; ++d)
      if (s.extent.periodic[d]) apart[d] -= s.extent.size[d] * std::round(apart[d] / s.extent.size[d]);
    widest = std::max(widest, apart.norm() / (2 * ball_radius) - 1);
  }
  return widest;
}

/// `hold`: cohesion over what the turning needs.
Scene turning(const Wheel& wheel, double angle, double hold, double friction) {
  const double rate = angle / time_step;
  Scene s(0, friction);
  s.world.materials[0].cohesion = hold * wheel.tension * rate * rate;
  s.world.contact_margin = 2;
  s.settings.max_sweeps = 64;
  const int ball = s.shape(Sphere{ball_radius});
  for (const Vec3& x : wheel.places)
    s.add(ball, Vec3::Constant(50) + x, rate * Vec3::UnitZ().cross(x), rate * Vec3::UnitZ());
  s.start();
  return s;
}

/// From angles that a step does not resolve up to those at which a ball moves by its radius in one.
TEST(Cohesion, HoldsTwoBallsThatTurnAboutEachOther) {
  for (const double friction : {0.0, 0.3})
    for (const double angle : {1e-4, 8e-4, 0.01, 0.1, 0.5})
      for (const double hold : {1.02, 10., 5e4}) {
        Scene s = turning(chain_of(2), angle, hold, friction);
        const double energy = s.kinetic_energy();
        const Vec3 l = s.angular_momentum();
        double widest = 0, most = 0;
        for (int i = 0; i < 2000; ++i) {
          s.run(1, time_step);
          widest = std::max(widest, widest_gap(s, 2, false));
          most = std::max(most, s.kinetic_energy());
        }
        EXPECT_LT(widest, std::max(2e-4, 0.1 * angle * angle)) << angle << ' ' << hold;
        EXPECT_LT(most, (1 + std::max(1e-9, 0.1 * angle * angle)) * energy) << angle << ' ' << hold;
        EXPECT_GT(s.kinetic_energy(), (1 - 4e-4) * energy) << angle << ' ' << hold;
        EXPECT_LT((s.angular_momentum() - l).norm(), 1e-10 * l.norm());
      }
}

TEST(Cohesion, PartsTwoBallsThatTurnFaster) {
  for (const double angle : {1e-3, 0.01, 0.1, 0.5}) {
    const double turned = 1 / std::sqrt(1 + angle * angle / 4);  // of a polygon, not of its circle
    Scene s = turning(chain_of(2), angle, 0.97 * turned, 0.3);
    s.run(static_cast<int>(100 / angle), time_step);
    EXPECT_GT(widest_gap(s, 2, false), 1) << angle;
  }
}

TEST(Cohesion, HoldsChainsAndRingsThatTurn) {
  for (const double friction : {0.0, 0.3})
    for (const double angle : {8e-4, 0.01, 0.1})
      for (const bool closed : {false, true})
        for (const double hold : {1.2, 5e3}) {
          const Wheel wheel = closed ? ring_of(6) : chain_of(5);
          Scene s = turning(wheel, angle, hold, friction);
          const double energy = s.kinetic_energy();
          const Vec3 l = s.angular_momentum();
          double widest = 0, most = 0;
          for (int i = 0; i < 1000; ++i) {
            s.run(1, time_step);
            widest = std::max(widest, widest_gap(s, int(wheel.places.size()), closed));
            most = std::max(most, s.kinetic_energy());
          }
          EXPECT_LT(widest, 2e-4) << angle << ' ' << closed << ' ' << friction << ' ' << hold;
          EXPECT_LT(most, (1 + 1e-5) * energy) << angle << ' ' << closed << ' ' << friction << ' ' << hold;
          EXPECT_GT(s.kinetic_energy(), (1 - 4e-4) * energy) << angle << ' ' << closed << ' ' << friction;
          EXPECT_LT((s.angular_momentum() - l).norm(), 1e-9 * l.norm());
        }
}

TEST(Cohesion, HoldsAcrossAPeriodicBorder) {
  Scene s(0, 0.3, Vec3::Constant(10));
  s.extent.periodic = {true, true, true};
  s.world.materials[0].cohesion = 10 * ball_radius * 1e2;
  s.world.contact_margin = 2;
  const double rate = 10;
  const int ball = s.shape(Sphere{ball_radius});
  for (const double side : {-1., 1.}) {
    const Vec3 x(side * ball_radius, 0, 0);
    s.add(ball, Vec3(5, 5, 5) + x, Vec3(7, 11, 0) + rate * Vec3::UnitZ().cross(x), rate * Vec3::UnitZ());
  }
  s.start();
  for (int i = 0; i < 3000; ++i) {
    s.run(1, time_step);
    ASSERT_LT(widest_gap(s, 2, false), 2e-4) << i;
  }
}

/// Two bodies that stick to each other by several contacts turn as one: how far one has moved, seen from the
/// other.
double moved_apart(const Shape& shape, const Vec3& half, const Vec3& axis, double angle, bool driven) {
  const double rate = angle / time_step;
  Scene s(0, 0.5);
  s.world.materials[0].cohesion = 20 * rate * rate * half.norm();
  s.world.contact_margin = 2;
  const int number = s.shape(shape);
  const Vec3 centre = driven ? Vec3(-half) : Vec3(Vec3::Zero());
  for (const double side : {-1., 1.}) {
    const Vec3 x = side * half;
    s.add(number, Vec3::Constant(50) + x, rate * axis.cross(x - centre), rate * axis);
  }
  if (driven) s.bodies.motion[0] = Motion::prescribed;
  s.start();
  const Vec3 before = s.bodies.orientation[0].conjugate() * (s.x(1) - s.x(0));
  s.run(1000, time_step);
  return (s.bodies.orientation[0].conjugate() * (s.x(1) - s.x(0)) - before).norm() / (2 * half.norm());
}

TEST(Cohesion, HoldsBodiesOfSeveralContactsThatTurn) {
  const Box cube{Vec3::Constant(ball_radius)};
  const Vec3 beside(ball_radius, 0, 0);
  for (const bool driven : {false, true})
    for (const double angle : {1e-3, 0.01, 0.1}) {
      if (driven && angle > 0.01) continue;                                     // creeps by the third order
      const double most = std::max(driven ? 2e-4 : 1e-4, 0.3 * angle * angle);  // in a thousand steps
      EXPECT_LT(moved_apart(cube, beside, Vec3::UnitZ(), angle, driven), most) << angle << driven;
      EXPECT_LT(moved_apart(cube, beside, Vec3(0.3, 0.2, 1).normalized(), angle, driven), most) << angle;
      EXPECT_LT(moved_apart(Cylinder{ball_radius, 2 * ball_radius}, beside, Vec3::UnitZ(), angle, driven),
                most);
    }
}

/// Balls that touch as a tree grows, in any directions, thrown as one that turns, each a little otherwise.
TEST(Cohesion, ClustersThatTumbleMakeNoEnergy) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<> u(-1, 1);
    const auto any = [&] { return Vec3(u(random), u(random), u(random)); };
    const double rate = 10;
    Scene s(0, seed % 2 ? 0.4 : 0.0);
    s.world.materials[0].cohesion = 100 * rate * rate * ball_radius;
    s.world.contact_margin = 2;
    s.settings.max_sweeps = 300;
    const int ball = s.shape(Sphere{ball_radius});
    std::vector<Vec3> places = {Vec3::Zero()};
    while (places.size() < 8) {
      const std::size_t parent = random() % places.size();
      const Vec3 x = places[parent] + 2 * ball_radius * any().normalized();
      bool free = true;
      for (std::size_t k = 0; k < places.size(); ++k)
        free &= k == parent || (places[k] - x).norm() > 2.2 * ball_radius;
      if (free) places.push_back(x);
    }
    const Vec3 spin = rate * any().normalized();
    for (const Vec3& x : places)
      s.add(ball, Vec3::Constant(50) + x, spin.cross(x) + 0.02 * rate * ball_radius * any(), spin);
    s.start();
    double energy = s.kinetic_energy(), least = energy;
    for (int i = 0; i < 1000; ++i) {
      s.run(1, time_step);
      least = std::min(least, s.kinetic_energy());
      ASSERT_LT(s.kinetic_energy(), least + 1e-3 * energy) << seed << ' ' << i;
    }
  }
}

/// A ball pulled off a plate by a force.
TEST(Cohesion, OfVanDerWaalsPartsAtItsLargestForce) {
  constexpr double hamaker = 1e-4, gap = 1e-3;
  const double most = hamaker * ball_radius / (6 * gap * gap);
  for (const double pull : {0.98 * most, 1.02 * most}) {
    Scene s(0, 0);
    s.world.materials[0].hamaker = hamaker, s.world.materials[0].hamaker_gap = gap;
    s.world.gravity = Vec3(0, 0, pull);
    s.add(s.shape(Sphere{ball_radius}), Vec3(50, 50, ball_radius));
    s.floor();
    s.start();
    s.run(1000, time_step);
    EXPECT_EQ(s.x(0)[2] - ball_radius > 10 * gap, pull > most) << pull;
  }
}

/// Two balls attract each other across a gap as the law says.
TEST(Cohesion, OfVanDerWaalsActsAcrossAGap) {
  Scene s(0, 0);
  s.world.materials[0].hamaker = 1e-8, s.world.materials[0].hamaker_gap = 1e-5;
  const int ball = s.shape(Sphere{ball_radius});
  s.add(ball, Vec3(50, 50, 50)), s.add(ball, Vec3(50.20004, 50, 50));
  s.start();
  s.run(1, 1e-7);
  const double force = 1e-8 * (ball_radius / 2) / (6 * 4e-5 * 4e-5);
  EXPECT_NEAR(s.v(0)[0], 1e-7 * force, 1e-3 * 1e-7 * force);
  EXPECT_NEAR(s.v(0)[0] + s.v(1)[0], 0, 1e-18);
}

/// The pull on a body at rest, of Hamaker's constant 1e-8.
double pull_on(Scene& s) {
  s.world.materials[0].hamaker = 1e-8, s.world.materials[0].hamaker_gap = 1e-4;
  s.start();
  s.run(1, 1e-7);
  return s.v(0).norm() / 1e-7;
}

TEST(Cohesion, OfVanDerWaalsIsThatOfTheCurvatures) {
  constexpr double near = 4e-4, unit = 1e-8 / (6 * near * near);
  for (const auto& plate : flat_grounds()) {
    Scene s = on_plate(plate, Sphere{ball_radius}, ball_radius + near);
    EXPECT_NEAR(pull_on(s), unit * ball_radius, 1e-6 * unit)
        << shape_name(plate.first) << ' ' << plate.second;
  }
  // rods of unlike radii that cross at a right angle: the geometric mean (Israelachvili)
  Scene rods(0, 0);
  rods.add_with_id(0, rods.shape(Capsule{0.1, 0.5}),
                   {Vec3(50, 50, 50), rotation_between(Vec3::UnitZ(), Vec3::UnitX())});
  rods.add_with_id(1, rods.shape(Cylinder{0.4, 1}),
                   {Vec3(50, 50, 49.5 - near), rotation_between(Vec3::UnitZ(), Vec3::UnitY())});
  EXPECT_NEAR(pull_on(rods), unit * 0.2, 1e-6 * unit);
  Scene balls(0, 0);  // far apart for their size
  const int ball = balls.shape(Sphere{0.01});
  balls.add(ball, Vec3(50, 50, 50)), balls.add(ball, Vec3(50, 50, 50.02 + near));
  EXPECT_NEAR(pull_on(balls), unit * 0.005, 1e-6 * unit * 0.01);
  Scene edge(0, 0);  // has no radius: nothing pulls by it
  edge.add(edge.shape(Sphere{0.1}), Vec3(50, 50, 50));
  edge.add(edge.shape(Box{{0.5, 0.5, 0.5}}),
           Vec3(50, 50, 50) + Vec3(0.5, 0, 0.5) + (0.1 + near) * std::sqrt(0.5) * Vec3(1, 0, 1));
  EXPECT_EQ(pull_on(edge), 0);
}

/// The force that holds a ball on a ceiling also presses it: friction holds it at the side of a wall.
TEST(Cohesion, PressesForFrictionToo) {
  for (const double friction : {0.52, 0.48}) {
    Scene s(0, friction);
    s.world.materials[0].cohesion = 2 * g;
    s.world.gravity = Vec3(g, 0, 0);
    s.add(s.shape(Box{Vec3::Constant(ball_radius)}), Vec3(50, 50, ball_radius));
    s.floor();
    s.start();
    s.run(500, time_step);
    EXPECT_EQ(s.x(0)[0] - 50 > 1e-3, friction < 0.5) << friction;
  }
}

}  // namespace
}  // namespace silt::rigid::testing

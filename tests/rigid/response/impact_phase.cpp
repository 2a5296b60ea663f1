// The impact phase: how impacts run through bodies that touch, against collisions of pairs one after the
// other and what any law of impact must keep; and what hears of impacts.
#include <gtest/gtest.h>

#include <random>

#include "rigid/response/impact_phase.hpp"
#include "tests/rigid/scene.hpp"

namespace silt::rigid::testing {
namespace {

using testing::Scene;

/// Touching balls of radius 1/2 in a row, but for a first gap; velocities along x.
Scene row_of_balls(double restitution, double friction, const std::vector<double>& velocities,
                   const std::vector<double>& masses = {}, double first_gap = 0) {
  Scene s(restitution, friction);
  s.settings.impact_sweeps = 2000;
  const int ball = s.shape(Sphere{0.5});
  for (std::size_t i = 0; i < velocities.size(); ++i)
    s.add(ball, {10 + static_cast<double>(i) + (i > 0 ? first_gap : 0), 10, 10}, {velocities[i], 0, 0},
          Vec3::Zero(), masses.empty() ? 1.0 : masses[i]);
  s.start();
  return s;
}

/// Touching balls in a row, by collisions of two at a time, from the left, until none approaches.
std::vector<double> one_after_the_other(std::vector<double> v, const std::vector<double>& m, double e) {
  for (bool any = true; any;) {
    any = false;
    for (std::size_t i = 0; i + 1 < v.size(); ++i) {
      const double u = v[i] - v[i + 1];
      if (u <= 1e-15) continue;
      const double impulse = (1 + e) * u * m[i] * m[i + 1] / (m[i] + m[i + 1]);
      v[i] -= impulse / m[i], v[i + 1] += impulse / m[i + 1];
      any = true;
    }
  }
  return v;
}

TEST(ImpactPhase, CradleOfFive) {
  for (double gap : {0.0, 0.25}) {
    Scene s = row_of_balls(1, 0, {1, 0, 0, 0, 0}, {}, gap);
    s.run(512, 1.0 / 1024);
    for (int k = 0; k < 5; ++k) EXPECT_EQ(s.v(k), Vec3(k == 4, 0, 0)) << k << " after a gap of " << gap;
  }
  Scene two = row_of_balls(1, 0, {1, 1, 0, 0, 0});  // two in, two out
  two.run(1);
  for (int k = 0; k < 5; ++k) EXPECT_NEAR(two.v(k)[0], k >= 3, 1e-12) << k;
}

/// A ball, alone or with another one on top of it, keeps its energy in every step of many falls: of the two,
/// which meet on the floor, up to what the sweeps leave.
TEST(ImpactPhase, BallsThatBounceForEverKeepTheirEnergy) {
  constexpr double gravity = 1e-3;
  for (const bool two : {false, true}) {
    Scene s(1, 0);
    s.settings.impact_sweeps = 100;
    s.world.gravity = {0, 0, -gravity};
    const int ball = s.shape(Sphere{0.5});
    s.add(ball, {10, 10, 5.3});
    if (two) s.add(ball, {10, 10, 8.1});
    s.floor();
    s.start();
    const auto energy = [&] {
      double sum = s.kinetic_energy();
      for (std::size_t row = 0; row < s.bodies.owned; ++row)
        sum += s.bodies.mass[row] * gravity * s.bodies.position[row][2];
      return sum;
    };
    const double first = energy();
    for (int step = 0; step < 4000; ++step) {
      s.run(1, 1.0);
      ASSERT_NEAR(energy(), first, (two ? 1e-8 : 1e-12) * first) << step;
    }
  }
}

TEST(ImpactPhase, ThreeBallsCollideOneAfterTheOther) {
  for (double e : {0.25, 0.5, 0.75, 0.9, 1.0})
    for (const std::vector<double>& masses : {std::vector<double>{1, 1, 1}, {1, 2, 1}, {3, 1, 2}}) {
      Scene s = row_of_balls(e, 0, {1, 0, 0}, masses);
      s.run(1);
      const std::vector<double> expected = one_after_the_other({1, 0, 0}, masses, e);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(s.v(k)[0], expected[k], 1e-8) << e << ", ball " << k;
      EXPECT_NEAR(s.momentum()[0], masses[0], 4e-15);
    }
}

TEST(ImpactPhase, BothSidesAtOnce) {
  for (double e : {1.0, 0.5}) {
    Scene s = row_of_balls(e, 0, {1, 0, -1});
    const double energy = s.kinetic_energy();
    s.run(1);
    EXPECT_NEAR(s.v(0)[0], -e, 1e-11);
    EXPECT_EQ(s.v(1)[0], 0);
    EXPECT_EQ(s.v(2)[0], -s.v(0)[0]) << "to the bit";
    EXPECT_NEAR(s.kinetic_energy() / energy, e * e, 1e-11);
  }
}

TEST(ImpactPhase, BoxLandsFlatAndOnItsEdge) {
  Scene s(0.5, 0);
  s.settings.impact_sweeps = 1000;
  const int box = s.shape(Box{{0.5, 0.5, 0.25}});
  s.add(box, {10, 10, 0.2505}, {0, 0, -1});
  const double tilt = 0.3;
  const Vec3 corner(0.5, 0, -0.25);
  const Vec3 turned = Eigen::AngleAxisd(tilt, Vec3::UnitY()) * corner;
  s.add_with_id(7, box, {{30, 10, -turned[2] + 5e-4}, Quat(Eigen::AngleAxisd(tilt, Vec3::UnitY()))},
                {0, 0, -1});
  s.floor();
  s.start();
  s.run(1);
  EXPECT_NEAR(s.v(0)[2], 0.5, 1e-12);
  EXPECT_LT(s.w(0).norm(), 1e-12);
  // on an edge: an impulse p at the arm x from the centre, u_n' = -e u_n
  const double inertia = (1.0 + 0.25) / 12, x = turned[0];
  const double p = 1.5 / (1 + x * x / inertia);
  EXPECT_NEAR(s.v(7)[2], -1 + p, 1e-3);  // the arm of the midpoint of the step
  EXPECT_NEAR(s.w(7)[1], -x * p / inertia, 2e-3);
}

Scene crowd(double restitution, double friction) {  // flies together, balls and boxes
  Scene s(restitution, friction, Vec3::Constant(20));
  s.settings.impact_sweeps = 300;
  const int ball = s.shape(Sphere{0.5}), box = s.shape(Box{{0.35, 0.45, 0.4}});
  std::mt19937 random(3);
  std::uniform_real_distribution<> u(-0.05, 0.05);
  for (int i = 0; i < 27; ++i) {
    const Vec3 d(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    s.add_with_id(
        i, i % 2 ? ball : box, {Vec3::Constant(10) + 1.1 * d + Vec3(u(random), u(random), u(random))},
        -d + Vec3(u(random), u(random), u(random)), 10 * Vec3(u(random), u(random), u(random)), 1 + i % 3);
  }
  return s;
}

TEST(ImpactPhase, EnergyNeverGrowsAndMomentumIsKept) {
  for (double e : {0.3, 0.9, 1.0})
    for (double mu : {0.0, 0.4}) {
      Scene s = crowd(e, mu);
      s.settings.correction = 0;  // which would move bodies, and with them angular momentum
      s.start();
      const Vec3 p = s.momentum(), l = s.angular_momentum();
      const double first = s.kinetic_energy();
      double energy = first, rise = 0;
      int sweeps = 0;
      for (int i = 0; i < 600; ++i) {
        s.run(1);
        sweeps += s.report.resolver.impact_sweeps;
        rise = std::max(rise, s.kinetic_energy() / energy - 1);
        energy = s.kinetic_energy();
      }
      EXPECT_GT(sweeps, 50);
      EXPECT_LT(rise, 1e-12) << e << ", " << mu;
      EXPECT_LT((s.momentum() - p).norm(), 1e-12);
      EXPECT_LT((s.angular_momentum() - l).norm(), 1e-10);
      EXPECT_LT(energy, e == 1 && mu == 0 ? 1.0000001 * first : 0.999 * first);
      if (e == 1 && mu == 0) {
        EXPECT_GT(energy, 0.999 * first) << "elastic";
      }
    }
}

TEST(ImpactPhase, SeveralRestitutionsDoNotMakeEnergy) {  // coupled impacts of a different e each
  Scene s = row_of_balls(1, 0, {1, 0, 0, 0, -1}, {1, 50, 0.02, 50, 1});
  s.world.materials = {{0, 0}, {1, 0}, {1, 0}, {0.1, 0}};  // 0-0: 0, 0-1: 1, 1-1: 0.1
  s.world.material_count = 2;
  s.bodies.material = {0, 1, 1, 0, 1};
  s.settings.warm_start = false;  // sweeps cut short from a warm start of such masses leave 1e-7
  s.start();
  double energy = s.kinetic_energy();
  for (int i = 0; i < 50; ++i) {
    s.run(1);
    EXPECT_LE(s.kinetic_energy(), energy * (1 + 1e-12));
    energy = s.kinetic_energy();
  }
  EXPECT_NEAR(s.momentum()[0], 0, 1e-14);
}

TEST(ImpactPhase, EveryPairHasItsOwnRestitution) {
  Scene s(0, 0);
  s.settings.impact_sweeps = 100;
  s.world.materials = {{0.8, 0}, {0.3, 0}, {0.3, 0}, {0.5, 0}};
  s.world.material_count = 2;
  const int ball = s.shape(Sphere{0.5});
  for (int i = 0; i < 3; ++i) {  // 0-0, 0-1, 1-1, far from each other
    s.add(ball, {10, 10.0 + 5 * i, 10}, {1, 0, 0});
    s.add(ball, {11, 10.0 + 5 * i, 10});
  }
  s.bodies.material = {0, 0, 0, 1, 1, 1};
  s.start();
  s.run(1);
  const double e[] = {0.8, 0.3, 0.5};
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(s.v(2 * i + 1)[0], (1 + e[i]) / 2, 1e-15) << i;
}

TEST(ImpactPhase, RestingBodiesNeedNone) {
  Scene s(0.5, 0.5);
  s.world.gravity = {0, 0, -9.81};
  s.settings.impact_sweeps = 50;
  const int box = s.shape(Box{{0.5, 0.5, 0.25}});
  for (int i = 0; i < 4; ++i) s.add(box, {10, 10, 0.25 + 0.5 * i});
  s.floor();
  s.start();
  s.run(500);
  for (int i = 0; i < 100; ++i) {
    s.run(1);
    EXPECT_EQ(s.report.resolver.impact_sweeps, 0);
  }
  EXPECT_LT(s.v(3).norm(), 1e-12);
  EXPECT_LT((s.x(3) - Vec3(10, 10, 1.75)).norm(), 1e-5);
}

struct Listener final : ImpactSink {
  mutable std::vector<Impact> heard;
  Vec3 operator()(BodySet&, const Impact& impact) const override {
    heard.push_back(impact);
    return 0.5 * impact.impulse * impact.normal;
  }
};

TEST(ImpactSink, HearsOfACollisionOnce) {
  const double masses[] = {1, 3}, speed = 1.5, e = 0.6;
  const auto listener = std::make_shared<Listener>();
  Scene s(e, 0);
  s.settings.impacts = listener;
  const int ball = s.shape(Sphere{0.5});
  const BodyId a = s.add(ball, {10, 10, 10}, {speed, 0, 0}, Vec3::Zero(), masses[0]);
  const BodyId b = s.add(ball, {11.2, 10, 10}, Vec3::Zero(), Vec3::Zero(), masses[1]);
  s.start();
  s.run(500);
  ASSERT_EQ(listener->heard.size(), 1u);
  const Impact& impact = listener->heard[0];
  EXPECT_EQ(impact.row_a, s.row(a));
  EXPECT_EQ(impact.row_b, s.row(b));
  EXPECT_EQ(impact.normal, Vec3(1, 0, 0));
  EXPECT_NEAR(impact.impulse, (1 + e) * speed / (1 / masses[0] + 1 / masses[1]), 1e-13);
  EXPECT_NEAR(impact.impulse, masses[1] * s.v(b)[0], 1e-13);
}

// Each of the corners is told of with its share.
TEST(ImpactSink, HearsOfAFlatLandingAsOfWhatItChanged) {
  const double speed = 1.5, e = 0.6;
  const auto listener = std::make_shared<Listener>();
  Scene s(e, 0);
  s.settings.impacts = listener;
  const BodyId box = s.add(s.shape(Box{{0.5, 0.5, 0.5}}), {10, 10, 0.7}, {0, 0, -speed});
  s.floor();
  s.start();
  Vec3 on_floor = Vec3::Zero();  // by the listener's word
  for (int i = 0; i < 500; ++i) {
    s.run(1);
    for (const OtherImpulse& other : s.step->other_impulses()) on_floor += other.impulse;
  }
  double sum = 0;
  for (const Impact& impact : listener->heard) sum += impact.impulse;
  EXPECT_GT(listener->heard.size(), 1u);
  EXPECT_NEAR(s.v(box)[2], e * speed, 1e-9);
  EXPECT_NEAR(sum, s.bodies.mass[s.row(box)] * (1 + e) * speed, 1e-9);
  EXPECT_LT((on_floor - Vec3(0, 0, -0.5 * sum)).norm(), 1e-12);
}

// A load that rests on a struck contact is no part of the impact.
TEST(ImpactSink, HearsOfNoLoadAtRest) {
  const auto listener = std::make_shared<Listener>();
  Scene s(0.5, 0.3);
  s.settings.impacts = listener;
  s.world.gravity = {0, 0, -9.81};
  const BodyId box = s.add(s.shape(Box{{0.5, 0.5, 0.5}}), {10, 10, 0.5});
  s.floor();
  s.start();
  s.run(1000);
  double sum = 0;
  for (const Impact& impact : listener->heard) {
    EXPECT_GT(impact.impulse, 0);
    sum += impact.impulse;
  }
  EXPECT_LT(sum, 1e-9 * s.bodies.mass[s.row(box)] * 9.81);
}

}  // namespace
}  // namespace silt::rigid::testing

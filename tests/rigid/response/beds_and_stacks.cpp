// Many contacts that bear a load by sffd: stacks stand, beds settle, and overlaps stay small.
#include <array>
#include <random>

#include "tests/rigid/beds.hpp"
#include "tests/rigid/response/on_every_backend.hpp"

namespace silt::rigid::testing {
namespace {

class SffdBeds : public OnEveryBackend {};
INSTANTIATE_TEST_SUITE_P(On, SffdBeds, every_backend, name_of_backend);

TEST_P(SffdBeds, TaperedStackOfTenBoxes) {
  for (int sweeps : {1, 4}) {
    Scene s(0, 0.5);
    s.settings.max_sweeps = sweeps;
    s.world.gravity = down;
    for (int i = 0; i < 10; ++i) {
      const double h = 0.5 - 0.04 * i;
      s.add(s.shape(Box{{h, h, 0.25}}), {10, 10, 0.25 + 0.5 * i}, Vec3::Zero(), Vec3::Zero(), 4 * h * h);
    }
    s.floor();
    s.start();
    s.run(3000);
    EXPECT_LT(s.deepest, sweeps == 1 ? 4e-3 : 9e-4) << "while the load spreads";
    EXPECT_LT(s.report.resolver.penetration, 1e-6);
    EXPECT_LT(s.v(9).norm(), sweeps == 1 ? 1e-9 : 1e-12);
    EXPECT_LT((s.x(9) - Vec3(10, 10, 4.75)).norm(), 1e-5);
  }
}

TEST_P(SffdBeds, AChainBearsItsLoadFromTheFirstStepOn) {  // statics: each contact has all that is above it
  constexpr int light = 12;
  constexpr double ratio = 1e3, dt = 1e-3;
  Scene s(0, 0.5);
  s.world.gravity = down;
  const int box = s.shape(Box{{0.5, 0.5, 0.5}});
  for (int i = 0; i <= light; ++i)
    s.add(box, {10, 10, 0.5 + i}, Vec3::Zero(), Vec3::Zero(), i == light ? ratio : 1);
  s.floor();
  s.start();
  s.run(1, dt);
  for (int i = 0; i <= light; ++i) {
    EXPECT_LT(s.v(i).norm(), 1e-6 * down.norm() * dt) << i;
    double borne = 0;
    for (const StoredImpulse& p : s.bodies.stored_impulses[s.row(i)])
      if (p.partner == BodyId(i + 1)) borne += p.impulse.z();
    const double above = i < light ? light - i - 1 + ratio : 0;
    EXPECT_NEAR(borne, above * down.norm() * dt, 1e-6 * ratio * down.norm() * dt) << i;
  }
}

TEST_P(SffdBeds, BedOfSpheresSettles) {
  Scene s = layers_of_spheres(0.3, 0.4, down);
  s.settings.max_sweeps = 16;
  s.start();
  s.run(1200);
  EXPECT_LT(s.deepest, 3e-2 * 0.1) << "while it falls together";
  s.deepest = 0;
  s.run(300);
  EXPECT_LT(s.deepest, 6.8e-4 * 10 * 0.1);
  EXPECT_LT(s.kinetic_energy() / 80, 0.02);
  EXPECT_GT(s.report.resolver.contacts, 120u);
  EXPECT_LT(s.report.resolver.cone_excess, 1e-12);
}

TEST_P(SffdBeds, BedOf125SpheresAtFourSweeps) {  // the deepest overlap of any contact in any step of a span
  Scene s(0.3, 0.4, {1, 1, 10});
  s.extent.periodic = {true, true, false};
  s.world.gravity = down;
  s.settings.max_sweeps = 4;
  const int ball = s.shape(Sphere{0.08});
  std::mt19937 random(5);
  std::uniform_real_distribution<> u(-0.004, 0.004);
  for (int i = 0; i < 125; ++i)
    s.add(ball, {0.1 + 0.2 * (i % 5) + u(random), 0.1 + 0.2 * (i / 5 % 5) + u(random), 0.1 + 0.2 * (i / 25)});
  s.floor();
  s.start();
  s.run(1200);
  EXPECT_LT(s.deepest, 2e-2 * 0.08) << "while it falls together";
  s.deepest = 0;
  s.run(300);
  EXPECT_LT(s.deepest, 2e-3 * 0.08) << "settled";
}

TEST_P(SffdBeds, StackOfTenEqualBoxesStands) {
  Scene s(0, 0.5);
  s.world.gravity = down;
  const int box = s.shape(Box{{0.5, 0.5, 0.5}});
  for (int i = 0; i < 10; ++i) s.add(box, {10, 10, 0.5 + i});
  s.floor();
  s.start();
  s.run(5000);
  for (int i = 0; i < 10; ++i) EXPECT_LT((s.x(i) - Vec3(10, 10, 0.5 + i)).norm(), 1e-3) << i;
  EXPECT_LT(s.v(9).norm(), 1e-6);
}

TEST_P(SffdBeds, CrookedStackComesToRest) {  // each box a twentieth of an edge beside the one below
  Scene s(0, 0.5);
  s.world.gravity = down;
  const int box = s.shape(Box{{0.1, 0.1, 0.1}});
  const double offsets[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
  std::array<Vec3, 5> start, settled;
  for (int i = 0; i < 5; ++i) {
    start[i] = {10 + 0.01 * offsets[i][0], 10 + 0.01 * offsets[i][1], 0.1 + 0.2 * i};
    s.add(box, start[i], Vec3::Zero(), Vec3::Zero(), 8);
  }
  s.floor();
  s.start();
  s.run(2000);
  for (int i = 0; i < 5; ++i) settled[i] = s.x(i);
  s.run(3000);
  for (int i = 0; i < 5; ++i) {
    EXPECT_LT((settled[i] - start[i]).norm(), 5e-5) << i << ": while the corners share out the weight";
    EXPECT_LT((s.x(i) - settled[i]).norm(), 1e-8) << i;
    EXPECT_LT(s.v(i).norm() + s.w(i).norm(), 1e-8) << i;
  }
}

}  // namespace
}  // namespace silt::rigid::testing

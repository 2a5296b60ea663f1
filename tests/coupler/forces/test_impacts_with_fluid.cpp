// Impacts act on the fluid that moves with bodies, and this is passed on to the fluid around them.
#include <gtest/gtest.h>

#include <cmath>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/forces/entrained_fluid.hpp"
#include "tests/rigid/scene.hpp"

namespace silt::coupler {
namespace {

using rigid::BodyId;
using rigid::Vec3;
using rigid::testing::Scene;

constexpr double entrained = 0.8;

Scene scene(double restitution, double friction) {
  Scene s(restitution, friction);
  s.settings.impacts = std::make_shared<EntrainedFluid>(entrained);
  return s;
}
/// A body that displaces so much mass.
void let_displace(Scene& s, BodyId id, double mass) {
  s.bodies.weight_in_fluid[s.row(id)] = 1 - mass / s.bodies.mass[s.row(id)];
}
Vec3 pending(const Scene& s, BodyId id) {
  return coupling_of(s.bodies, s.row(id)).pending_impact();
}

TEST(ImpactsWithFluid, ReverseWhatMovesWithTheBodies) {
  const double masses[] = {1, 2}, displaced[] = {0.9, 0.4}, speed = 1.5, e = 0.6;
  Scene s = scene(e, 0);
  const int ball = s.shape(rigid::Sphere{0.5});
  const BodyId a = s.add(ball, {10, 10, 10}, {speed, 0, 0}, Vec3::Zero(), masses[0]);
  const BodyId b = s.add(ball, {11.2, 10, 10}, Vec3::Zero(), Vec3::Zero(), masses[1]);
  let_displace(s, a, displaced[0]);
  let_displace(s, b, displaced[1]);
  s.start();
  s.run(500);
  // the bodies alone part as ever; with all that the impact gives, so do bodies and entrained masses together
  EXPECT_NEAR(s.v(b)[0] - s.v(a)[0], e * speed, 1e-14);
  EXPECT_EQ(pending(s, a), Vec3(-pending(s, b)));
  const double impulse = masses[1] * s.v(b)[0] + pending(s, b)[0];
  const auto together = [&](int k) { return masses[k] + entrained * displaced[k]; };
  EXPECT_NEAR(impulse * (1 / together(0) + 1 / together(1)), (1 + e) * speed, 1e-14);
}

TEST(ImpactsWithFluid, OnAWall) {
  Scene s = scene(0.5, 0.3);
  const BodyId ball = s.add(s.shape(rigid::Sphere{0.5}), {10, 10, 1}, {0.4, 0, -2});
  let_displace(s, ball, 0.25);
  s.floor();
  s.start();
  s.run(500);
  EXPECT_NEAR(pending(s, ball)[2], entrained * 0.25 * 1.5 * 2, 1e-14);
  EXPECT_EQ(pending(s, ball)[0], 0);
}

// Each of the four corners has to be reversed, none of them gets the impulse of a whole box.
TEST(ImpactsWithFluid, OfAFaceThatLandsFlat) {
  constexpr double e = 0.5, speed = 2, displaced = 0.25;
  Scene s = scene(e, 0.3);
  const BodyId box = s.add(s.shape(rigid::Box{{1, 1, 1}}), {10, 10, 0.7}, {0, 0, -speed});
  let_displace(s, box, displaced);
  s.floor();
  s.start();
  s.run(300);
  EXPECT_NEAR(s.v(box)[2], e * speed, 1e-12);
  EXPECT_NEAR(pending(s, box)[2], entrained * displaced * (1 + e) * speed, 1e-12);
}

TEST(ImpactsWithFluid, RestIsNone) {
  Scene s = scene(0.5, 0.3);
  s.world.gravity = {0, 0, -9.81};
  const int box = s.shape(rigid::Box{{1, 1, 1}});
  const BodyId below = s.add(box, {10, 10, 0.5}), above = s.add(box, {10, 10, 1.5});
  for (const BodyId id : {below, above}) let_displace(s, id, 0.5);
  s.floor();
  s.start();
  s.run(1000);
  const double weight = 2 * 9.81;  // its impulse on the floor
  EXPECT_LT(pending(s, below).norm() + pending(s, above).norm(), 1e-9 * weight);
}

TEST(ImpactsWithFluid, NothingDisplacedNothingPending) {
  Scene s = scene(1, 0);
  const BodyId ball = s.add(s.shape(rigid::Sphere{0.5}), {10, 10, 1}, {0, 0, -2});
  s.floor();
  s.start();
  s.run(500);
  EXPECT_GT(s.v(ball)[2], 0);
  EXPECT_EQ(pending(s, ball), Vec3::Zero());
}

constexpr double radius = 6, density = 2.5;  // cells; over that of the fluid
const Vec3 impact(0.3, -0.1, 2);             // impulse, lattice units

/// Bodies of the volume of a sphere with something pending; the second one is a copy.
rigid::BodySet struck(const Vec3& pending) {
  rigid::BodySet bodies;
  for (rigid::BodyId id = 1; id <= 2; ++id) {
    rigid::BodyRecord r;
    r.id = id;
    r.mass = density * 4 * M_PI / 3 * radius * radius * radius;
    bodies.add(r);
  }
  bodies.owned = 1, bodies.copies = 1;
  for (std::size_t row = 0; row < 2; ++row) {
    bodies.weight_in_fluid[row] = 1 - 1 / density;
    coupling_of(bodies, row).pending_impact() = pending;
  }
  return bodies;
}

// In the time in which sound goes a radius far, all but 1/e is passed on.
TEST(EntrainedFluid, FollowsWithTheSpeedOfSound) {
  rigid::BodySet bodies = struck(impact);
  for (int t = 1; t <= 60; ++t) {
    apply_pending_impacts(bodies);
    const double left = std::exp(-t / std::sqrt(3.0) / radius);
    EXPECT_LT((coupling_of(bodies, 0).pending_impact() - left * impact).norm(), 1e-14) << t;
    EXPECT_LT((bodies.force[0].value() - (1 - left) * impact).norm(), 1e-13) << t;
  }
}

TEST(EntrainedFluid, IsPassedOnWholeInTheEnd) {
  rigid::BodySet bodies = struck(impact);
  for (int t = 0; t < 400; ++t) apply_pending_impacts(bodies);
  EXPECT_EQ(coupling_of(bodies, 0).pending_impact(), Vec3::Zero());
  EXPECT_LT((bodies.force[0].value() - impact).norm(), 1e-13);
}

TEST(EntrainedFluid, OfCopiesIsLeftToTheirOwners) {
  rigid::BodySet bodies = struck(impact);
  apply_pending_impacts(bodies);
  EXPECT_EQ(coupling_of(bodies, 1).pending_impact(), impact);
  EXPECT_EQ(bodies.force[1].value(), Vec3::Zero());
}

}  // namespace
}  // namespace silt::coupler

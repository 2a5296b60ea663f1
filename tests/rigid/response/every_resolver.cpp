// What every contact resolver keeps, and the projection of the classic one.
#include <gtest/gtest.h>

#include "rigid/response/ffd_resolver.hpp"
#include "tests/errors.hpp"
#include "tests/rigid/scene.hpp"

namespace silt::rigid::testing {
namespace {

using testing::g;
using testing::Scene;

// Newton's restitution and momentum of a central collision; without a correction of overlaps, which ffd's
// velocities take part in.
TEST(EveryResolver, CollidesTwoBalls) {
  const double speed = 1.5, e = 0.6, masses[] = {1, 2};
  for (const ResolverModel& model : resolver_models()) {
    const std::string_view name = model.name;
    Scene s(e, 0);
    s.settings.correction = 0;
    const int ball = s.shape(Sphere{0.5});
    const BodyId a = s.add(ball, {10, 10, 10}, {speed, 0, 0}, Vec3::Zero(), masses[0]);
    const BodyId b = s.add(ball, {11.2, 10, 10}, Vec3::Zero(), Vec3::Zero(), masses[1]);
    s.start(name);
    s.run(500);
    EXPECT_NEAR(s.v(b)[0] - s.v(a)[0], e * speed, 1e-13) << name;
    EXPECT_NEAR(s.momentum()[0], masses[0] * speed, 1e-13) << name;
  }
}

TEST(EveryResolver, HoldsABoxAtRest) {
  for (const ResolverModel& model : resolver_models()) {
    const std::string_view name = model.name;
    Scene s(0.3, 0.5);
    s.world.gravity = {0, 0, -9.81};
    const BodyId box = s.add(s.shape(Box{{0.5, 0.5, 0.5}}), {10, 10, 0.5});
    s.floor();
    s.start(name);
    s.run(1000);
    const Vec3 moved = s.bodies.position[s.row(box)] - Vec3(10, 10, 0.5);
    EXPECT_LT(moved.norm(), 1e-4) << name;
    EXPECT_LT(s.v(box).norm(), 9.81 * 1e-3) << name;  // a step's kick: ffd takes it back in the next step
  }
}

TEST(EveryResolver, UnknownNamesAreRefusedWithTheKnownOnes) {
  const std::string error = tests::error_of<std::invalid_argument>([] { make_resolver("sfdf", {}); });
  for (const ResolverModel& model : resolver_models()) EXPECT_TEXT(error, model.name);
}

TEST(DualActiveSet, ClosestPointOfAPolyhedron) {
  const auto half_space = [](std::initializer_list<double> n, double offset) {
    HalfSpace6 h{Vec6::Zero(), offset};
    std::copy(n.begin(), n.end(), h.normal.data());
    return h;
  };
  EXPECT_EQ(closest_to_origin({}).y, Vec6::Zero());
  const std::vector corner = {half_space({1, 0, 0}, 1), half_space({0, 2, 0}, 4), half_space({1, 1, 0}, 2)};
  const auto p = closest_to_origin(corner);
  EXPECT_TRUE(p.feasible);
  EXPECT_LT((p.y - (Vec6() << 1, 2, 0, 0, 0, 0).finished()).norm(), 1e-14);
  const std::vector redundant = {half_space({1, 0, 0}, 1), half_space({1, 0, 0}, 1),
                                 half_space({1, 1e-3, 0}, 1), half_space({1, -1e-3, 0}, 1)};
  EXPECT_NEAR(closest_to_origin(redundant).y[0], 1, 1e-12);
  const std::vector contradiction = {half_space({1, 0, 0}, 1), half_space({-1, 0, 0}, 0)};
  EXPECT_FALSE(closest_to_origin(contradiction).feasible);
}

TEST(DualActiveSet, OptimalForRandomConstraints) {  // Karush-Kuhn-Tucker: y is a sum of non-negative normals
  srand(1);
  for (int trial = 0; trial < 500; ++trial) {
    std::vector<HalfSpace6> c(1 + trial % 12);
    for (HalfSpace6& h : c) h = {Vec6::Random(), 0.5};
    const auto p = closest_to_origin(c);
    if (!p.feasible) continue;
    for (const HalfSpace6& h : c) EXPECT_GE(h.normal.dot(p.y) - h.offset, -1e-9);
    for (int k = 0; k < 50; ++k) {  // no feasible point is closer
      const Vec6 other = p.y + 0.1 * Vec6::Random();
      bool feasible = true;
      for (const HalfSpace6& h : c) feasible = feasible && h.normal.dot(other) >= h.offset;
      if (feasible) {
        EXPECT_GE(other.norm(), p.y.norm() - 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace silt::rigid::testing

// Flat contacts of boxes and capsules, on every collision backend.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "adapters/automatic/collision_factory.hpp"
#include "tests/adapters/collision_scenes.hpp"

namespace silt::tests {
namespace {

class Patches : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<rigid::CollisionBackend> backend = adapters::make_backend(GetParam());
  Points at(const Pair& p, double tolerance = 0.5) { return collide(*backend, p, tolerance); }
};

/// Each expected corner (x, y) is one of the points', and the other way round.
void expect_corners(const Points& points, std::vector<Vec3> corners, double gap) {
  ASSERT_EQ(points.size(), corners.size());
  for (const auto& p : points) {
    EXPECT_NEAR(p.gap, gap, 1e-12);
    const auto near = std::min_element(corners.begin(), corners.end(), [&](const Vec3& c, const Vec3& d) {
      return (c - p.on_a).head<2>().norm() < (d - p.on_a).head<2>().norm();
    });
    EXPECT_LE((*near - p.on_a).head<2>().norm(), 1e-9) << p.on_a.transpose();
    corners.erase(near);
  }
}

TEST_P(Patches, BoxOnPlaneHasFourPoints) {
  for (const double gap : {0.0, 0.3, -0.2}) {
    const Pair p{
        rigid::Box{{4, 3, 2}}, rigid::HalfSpace{Vec3::UnitZ()}, {}, {Vec3(0, 0, -2 - gap), Quat::Identity()}};
    const Points points = at(p);
    expect_corners(points, {{4, 3, 0}, {-4, 3, 0}, {4, -3, 0}, {-4, -3, 0}}, gap);
    for (const auto& c : points) EXPECT_NEAR(c.normal.z(), -1, 1e-15);
  }
}

TEST_P(Patches, BoxesTouchAtTheCornersOfWhatTheyShare) {
  for (const double gap : {0.0, 0.25, -0.25})
    expect_corners(at(stacked_boxes({2, 1, 2}, {1, 1, 0}, 0, gap)),
                   {{3, 2, 0}, {-1, 2, 0}, {3, 0, 0}, {-1, 0, 0}}, gap);
  const std::vector<Vec3> of_the_lower{{4, 3, 0}, {-4, 3, 0}, {4, -3, 0}, {-4, -3, 0}};
  expect_corners(at(stacked_boxes({9, 8, 2}, {1, 1, 0}, 10, -0.1)), of_the_lower, -0.1);
  expect_corners(at(stacked_boxes({4, 3, 2}, {0, 0, 0}, 0, -0.1)), of_the_lower, -0.1);
  expect_corners(at(stacked_boxes({2, 1, 2}, {4, 0, 0}, 0, -0.1)),
                 {{2, 1, 0}, {2, -1, 0}, {4, 1, 0}, {4, -1, 0}}, -0.1);  // half over the edge
}

TEST_P(Patches, TurnedBoxesTouchAtEightCorners) {
  // a square of half edge 3.5 turned by 45 degrees, diagonal half 4.95, on the rectangle 4 x 3: 4 cuts are on
  // y, 4 on x
  const double half = 3.5, reach = half * std::sqrt(2.0);
  std::vector<Vec3> corners;
  for (const double sx : {-1.0, 1.0})
    for (const double sy : {-1.0, 1.0}) {
      corners.emplace_back(sx * 4, sy * (reach - 4), 0);
      corners.emplace_back(sx * (reach - 3), sy * 3, 0);
    }
  expect_corners(at(stacked_boxes({half, half, 2}, {0, 0, 0}, 45, -0.1)), corners, -0.1);
}

TEST_P(Patches, CrossedBeamsHaveNoVertexOverTheOther) {
  for (const double degrees : {90.0, 75.0, 60.0})
    for (const double gap : {0.4, 0.0, -0.4}) {
      const Points points = at(stacked_boxes({40, 1, 2}, {0.3, 0.2, 0}, degrees, gap));
      EXPECT_EQ(points.size(), 4u) << degrees << " " << gap;
      for (const auto& p : points) EXPECT_NEAR(p.gap, gap, 1e-12) << degrees << " " << gap;
      const Pair capsule{
          rigid::Box{{4, 1, 2}}, rigid::Capsule{2, 30}, {}, {Vec3(0, 0, 4 + gap), turned(90, Vec3::UnitX())}};
      EXPECT_EQ(at(capsule).size(), 2u) << gap;
      EXPECT_NEAR(deepest(at(capsule)).gap, gap, 1e-12) << gap;
    }
}

TEST_P(Patches, BeamsAcrossEachCornerHaveNoVertexOverTheOther) {
  for (const double x : {-2.0, 2.0})
    for (const double y : {-1.5, 1.5})
      for (const double gap : {0.4, 0.0, -0.4}) {
        const Points points = at(stacked_boxes({40, 1, 2}, {x, y, 0}, x * y > 0 ? -45 : 45, gap));
        EXPECT_EQ(points.size(), 4u) << x << " " << y << " " << gap;
        for (const auto& p : points) EXPECT_NEAR(p.gap, gap, 1e-12);
      }
}

TEST_P(Patches, NoMarginOnFaces) {
  for (const double gap : {1e-3, 0.02, 0.04, 0.3, -1e-3, -0.04, -0.3}) {
    for (const auto& p : at(stacked_boxes({2, 1, 2}, {0.3, 0.2, 0}, 17, gap))) EXPECT_NEAR(p.gap, gap, 1e-12);
    const Pair ball{rigid::Box{{4, 3, 2}}, rigid::Sphere{3}, {}, {Vec3(1, 1, 5 + gap), Quat::Identity()}};
    EXPECT_NEAR(deepest(at(ball)).gap, gap, 1e-12);
  }
}

TEST_P(Patches, CapsulesLyingStandingAndSideBySide) {
  const rigid::Capsule capsule{2, 3};
  const Pose lying{Vec3(0, 0, 2.1), turned(90, Vec3::UnitX())}, standing{Vec3(0, 0, 5.1), Quat::Identity()};
  const Pair on_plane{capsule, rigid::HalfSpace{Vec3::UnitZ()}, lying, {}};
  expect_corners(at(on_plane), {{0, 3, 0}, {0, -3, 0}}, 0.1);
  EXPECT_EQ(at({capsule, rigid::HalfSpace{Vec3::UnitZ()}, standing, {}}).size(), 1u);
  const Pose below{Vec3(0, 0, -2), Quat::Identity()};
  expect_corners(at({capsule, rigid::Box{{4, 4, 2}}, lying, below}), {{0, 3, 0}, {0, -3, 0}}, 0.1);
  expect_corners(at({capsule, rigid::Box{{4, 1, 2}}, lying, below}), {{0, 1, 0}, {0, -1, 0}}, 0.1);
  EXPECT_EQ(at({capsule, rigid::Box{{4, 4, 2}}, standing, below}).size(), 1u);
  const Pose beside{Vec3(0, 1, -2), turned(90, Vec3::UnitX())};
  expect_corners(at({capsule, rigid::Capsule{2, 3}, lying, beside}), {{0, 3, 0}, {0, -2, 0}}, 0.1);
  EXPECT_EQ(at({capsule, capsule, standing, {Vec3(0, 0, -5), Quat::Identity()}}).size(), 1u);
}

TEST_P(Patches, NearlyFlatBoxesKeepFourPoints) {
  std::mt19937_64 random(5);
  for (const double degrees : {1e-9, 1e-7, 1e-5, 1e-3, 0.1})
    for (int i = 0; i < 20; ++i) {
      Pair p = stacked_boxes({2, 1.5, 2}, {0.5, 0.2, 0}, 7.0 * i, 0.05);
      p.pose_b.orientation = turned(degrees, random_direction(random)) * p.pose_b.orientation;
      EXPECT_GE(at(p).size(), 4u) << degrees;
      p.pose_b.position.z() -= 0.1;
      EXPECT_GE(at(p).size(), 4u) << degrees;
      EXPECT_NEAR(deepest(at(p)).gap, reference_gap(p).gap, 1e-9) << degrees;
    }
}

INSTANTIATE_TEST_SUITE_P(Backends, Patches, testing::ValuesIn(every_backend()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace silt::tests

// Cylinders, ellipsoids and polyhedra at rest, degenerate poses and stable features, on every collision
// backend.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "adapters/automatic/collision_factory.hpp"
#include "rigid/collision/manifold.hpp"
#include "tests/adapters/collision_scenes.hpp"

namespace silt::tests {
namespace {

using std::numbers::pi;

const rigid::Cylinder drum{2, 3};
const rigid::HalfSpace floor_{Vec3::UnitZ()};

Pose at_height(double z, const Quat& turn = Quat::Identity()) {
  return {Vec3(0, 0, z), turn};
}

/// A prism with a regular polygon for a base, half height 1.
rigid::Polyhedron prism(int corners, double radius) {
  std::vector<Vec3> points;
  for (int k = 0; k < corners; ++k)
    for (const double z : {-1.0, 1.0})
      points.emplace_back(radius * std::cos(2 * pi * k / corners), radius * std::sin(2 * pi * k / corners),
                          z);
  return hull_of(points);
}

class ConvexPatches : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<rigid::CollisionBackend> backend = adapters::make_backend(GetParam());
  Points at(const Pair& p, double tolerance = 0.5) { return collide(*backend, p, tolerance); }
  Points mirrored(const Pair& p) { return at({p.b, p.a, p.pose_b, p.pose_a}); }
};

/// All at `gap`, with the axis of the contact inside their hull by more than `inset`: a body on them stands.
void expect_stands(const Points& points, double gap, double inset) {
  ASSERT_GE(points.size(), 4u);
  std::set<std::uint32_t> ids;
  for (const auto& p : points) {
    EXPECT_NEAR(p.gap, gap, 1e-12);
    EXPECT_NEAR(std::abs(p.normal.z()), 1, 1e-14);
    ids.insert(p.feature);
  }
  EXPECT_EQ(ids.size(), points.size());
  for (int k = 0; k < 64; ++k) {
    const Vec3 side(std::cos(2 * pi * k / 64), std::sin(2 * pi * k / 64), 0);
    double furthest = -1;
    for (const auto& p : points) furthest = std::max(furthest, side.dot(p.on_a));
    EXPECT_GE(furthest, inset);
  }
}

TEST_P(ConvexPatches, ACylinderStandsOnEverythingFlat) {
  for (const double gap : {0.0, 0.2, -0.2}) {
    expect_stands(at({drum, floor_, at_height(3 + gap), {}}), gap, 1.8);
    for (const auto& below :
         std::vector<ConvexShape>{rigid::Box{{4, 4, 2}}, drum, prism(6, 4), prism(5, 3)}) {
      const bool tall = std::holds_alternative<rigid::Cylinder>(below);
      const bool box = std::holds_alternative<rigid::Box>(below);
      const double top = tall ? 3 : box ? 2 : 1;
      const Pair p{drum, below, at_height(top + 3 + gap), at_height(0, turned(11, Vec3::UnitZ()))};
      expect_stands(at(p), gap, 1.6);
      expect_stands(mirrored(p), gap, 1.6);
    }
  }
}

TEST_P(ConvexPatches, ACylinderOnASmallerBoxRestsOnTheBoxsCorners) {
  const Points points = at({drum, rigid::Box{{1, 0.5, 1}}, at_height(4.1), {}});
  ASSERT_EQ(points.size(), 4u);
  for (const auto& p : points) {
    EXPECT_NEAR(p.gap, 0.1, 1e-12);
    EXPECT_NEAR(std::abs(p.on_a.x()), 1, 1e-12);
    EXPECT_NEAR(std::abs(p.on_a.y()), 0.5, 1e-12);
  }
}

TEST_P(ConvexPatches, ACylinderHalfOverAnEdgeIsHeldUpToTheEdge) {
  const Points points = at({drum, rigid::Box{{4, 4, 1}}, {Vec3(4.5, 0, 4), Quat::Identity()}, {}});
  double furthest = 0;
  for (const auto& p : points) furthest = std::max(furthest, p.on_a.x());
  EXPECT_GE(points.size(), 4u);
  EXPECT_NEAR(furthest, 4, 1e-12);
}

TEST_P(ConvexPatches, ATiltedCylindersLowestRimPointIsThere) {
  for (const double degrees : {1e-6, 1e-3, 0.5, 20.0, 50.0, 89.0}) {
    const Quat tilt = turned(degrees, Vec3(1, 0.3, 0));
    const double lowest = 3 * std::cos(degrees * pi / 180) + 2 * std::sin(degrees * pi / 180);
    const Points plane = at({drum, floor_, at_height(lowest + 0.05, tilt), {}});
    EXPECT_NEAR(deepest(plane).gap, 0.05, 1e-12) << degrees;
    const Points box = at({drum, rigid::Box{{9, 9, 1}}, at_height(lowest + 1.05, tilt), {}});
    EXPECT_NEAR(deepest(box).gap, 0.05, 1e-12) << degrees;
    if (degrees > 1e-4) {
      EXPECT_LE((deepest(box).on_a - deepest(plane).on_a - Vec3::UnitZ()).norm(), 1e-6) << degrees;
    }
    if (degrees < 1) {
      EXPECT_GE(box.size(), 4u) << degrees;
      EXPECT_GE(plane.size(), 4u) << degrees;
    }
  }
}

TEST_P(ConvexPatches, ALyingCylinderTouchesAlongItsLine) {
  for (const double rolled : {0.0, 10.0, 22.5, 40.0})  // the rim points of its frame come down on either side
    for (const auto& [shape, top] : {std::pair<ConvexShape, double>(floor_, 0),
                                     {rigid::Box{{9, 9, 1}}, 1},
                                     {prism(6, 8), 1},
                                     {rigid::Cylinder{9, 1}, 1}}) {
      const Quat lying = turned(90, Vec3::UnitX()) * turned(rolled, Vec3::UnitZ());
      const Points points = at({drum, shape, at_height(top + 2.1, lying), {}});
      ASSERT_EQ(points.size(), 2u) << rigid::shape_name(
          rigid::Shape(std::visit([](auto s) { return rigid::Shape(s); }, shape)));
      for (const auto& p : points) {
        EXPECT_NEAR(p.gap, 0.1, 1e-12);
        EXPECT_NEAR(std::abs(p.on_a.y()), 3, 1e-12);
        EXPECT_NEAR(p.on_a.x(), 0, 1e-9);
      }
    }
}

TEST_P(ConvexPatches, ACylinderThatRollsOnItsRimHasOnePoint) {
  for (const double degrees : {8.0, 20.0, 44.0, 46.0, 70.0})
    for (const double rolled : {0.0, 10.0, 22.5, 40.0}) {
      const Quat tilt = turned(degrees, Vec3::UnitX()) * turned(rolled, Vec3::UnitZ());
      const double lowest = 3 * std::cos(degrees * pi / 180) + 2 * std::sin(degrees * pi / 180);
      for (const auto& [shape, top] :
           {std::pair<ConvexShape, double>(floor_, 0), {rigid::Box{{9, 9, 1}}, 1}, {prism(6, 8), 1}})
        EXPECT_EQ(at({drum, shape, at_height(top + lowest + 0.01, tilt), {}}, 0.4).size(), 1u) << degrees;
    }
}

TEST_P(ConvexPatches, ParallelCylindersTouchAlongTheirCommonLength) {
  const Quat lying = turned(90, Vec3::UnitX());
  for (const double gap : {0.1, 0.0, -0.1}) {
    for (const auto& other : std::vector<ConvexShape>{drum, rigid::Capsule{2, 3}}) {
      const Points points = at({drum, other, at_height(4 + gap, lying), {Vec3(0, 1, 0), lying}});
      ASSERT_EQ(points.size(), 2u);
      std::vector<double> y{points[0].on_a.y(), points[1].on_a.y()};
      std::sort(y.begin(), y.end());
      EXPECT_NEAR(y[0], -2, 1e-9);
      EXPECT_NEAR(y[1], 3, 1e-9);
      for (const auto& p : points) EXPECT_NEAR(p.gap, gap, 1e-12);
    }
    const Points crossed =
        at({drum, drum, at_height(4 + gap, lying), at_height(0, turned(90, Vec3::UnitY()))});
    ASSERT_EQ(crossed.size(), 1u);
    EXPECT_NEAR(crossed[0].gap, gap, 1e-12);
    EXPECT_LE(crossed[0].on_a.head<2>().norm(), 1e-9);
  }
}

TEST_P(ConvexPatches, PolyhedraStandOnTheirFaces) {
  for (const double gap : {0.0, 0.1, -0.1}) {
    EXPECT_EQ(at({prism(6, 3), floor_, at_height(1 + gap), {}}).size(), 6u);
    for (const auto& below : std::vector<ConvexShape>{rigid::Box{{4, 4, 1}}, prism(4, 5), prism(7, 4)}) {
      const Pair p{prism(6, 3), below, at_height(2 + gap), at_height(0, turned(7, Vec3::UnitZ()))};
      expect_stands(at(p), gap, 2);
      expect_stands(mirrored(p), gap, 2);
    }
  }
}

TEST_P(ConvexPatches, ABoxAsAPolyhedronIsTheBox) {
  std::vector<Vec3> corners;
  for (int v = 0; v < 8; ++v) corners.emplace_back(v & 1 ? 2 : -2, v & 2 ? 1 : -1, v & 4 ? 2 : -2);
  const rigid::Polyhedron box = hull_of(corners);
  for (const double degrees : {0.0, 17.0, 45.0})
    for (const double gap : {0.2, -0.2}) {
      Pair p = stacked_boxes({2, 1, 2}, {1, 1, 0}, degrees, gap);
      const Points expected = at(p);
      p.b = box;
      const Points points = at(p);
      ASSERT_EQ(points.size(), expected.size()) << degrees << " " << gap;
      for (const auto& e : expected)
        EXPECT_TRUE(std::any_of(points.begin(), points.end(),
                                [&](const auto& c) {
                                  return (c.on_a - e.on_a).norm() < 1e-9 && (c.on_b - e.on_b).norm() < 1e-9;
                                }))
            << degrees << " " << gap;
    }
}

TEST_P(ConvexPatches, EdgeOnEdge) {
  // a cylinder's rim over the edge of a box; two edges of polyhedra
  const double s = std::sqrt(0.5);
  const Quat tip = turned(45, Vec3::UnitY());
  for (const double gap : {0.1, -0.01}) {
    const Pair rim{drum,
                   rigid::Box{{4, 4, 4}},
                   {Vec3(0, 0, 4 * 2 * s + 5 * s + gap), tip},
                   at_height(0, turned(45, Vec3::UnitX()))};
    EXPECT_NEAR(deepest(at(rim)).gap, reference_gap(rim).gap, 1e-12);
    EXPECT_NEAR(deepest(mirrored(rim)).gap, reference_gap(rim).gap, 1e-12);
    const Pair edges{prism(4, 2),
                     prism(4, 2),
                     {Vec3(0, 0, 2 * (1 + 2 * s * s) * s * 2 + gap),
                      turned(45, Vec3::UnitX()) * turned(45, Vec3::UnitZ())},
                     {Vec3::Zero(), turned(45, Vec3::UnitY()) * turned(45, Vec3::UnitZ())}};
    const Points points = at(edges, 5);
    EXPECT_NEAR(deepest(points).gap, reference_gap(edges).gap, 1e-12);
  }
}

TEST_P(ConvexPatches, CoaxialCylinders) {
  for (const double shift : {0.0, 1e-9, 0.3}) {
    for (const double depth : {0.1, 1.0, 2.5}) {
      const Pair p{drum, rigid::Cylinder{1.5, 3}, {}, {Vec3(shift, 0, 6 - depth), Quat::Identity()}};
      const double sideways = shift - 3.5;  // radii less the distance of the axes
      EXPECT_NEAR(deepest(at(p)).gap, std::max(-depth, sideways), 1e-12) << shift << " " << depth;
    }
  }
}

TEST_P(ConvexPatches, DegeneratePosesGiveUnitNormalsAndTheLeastDepth) {
  const rigid::Ellipsoid egg{{2, 3, 4}}, unit{{1, 1, 1}};
  const rigid::Capsule capsule{2, 3};
  const rigid::Box box{{4, 3, 2}};
  const Pose across{Vec3::Zero(), turned(90, Vec3::UnitX())};
  const auto to = [](double x, double y, double z) { return Pose{Vec3(x, y, z), Quat::Identity()}; };
  const std::vector<std::pair<Pair, double>> poses = {
      {{rigid::Sphere{2}, rigid::Sphere{3}, {}, {}}, -5},  // concentric
      {{rigid::Sphere{2}, rigid::Sphere{3}, {}, to(1e-160, 0, 0)}, -5},
      {{rigid::Sphere{2}, box, {}, {}}, -4},           // centre in centre
      {{rigid::Sphere{2}, box, to(0, 0, 2), {}}, -2},  // centre on the face
      {{rigid::Sphere{2}, box, to(4, 3, 2), {}}, -2},  // centre on the corner
      {{rigid::Sphere{2}, capsule, {}, {}}, -4},       // centre on the axis
      {{capsule, capsule, {}, {}}, -4},                // the same place
      {{capsule, capsule, {}, across}, -4},            // crossed
      {{capsule, capsule, {}, to(0, 0, 3)}, -4},       // one line
      {{capsule, box, {}, {}}, -5},
      {{capsule, box, across, {}}, -4},
      {{box, box, {}, {}}, -4},
      {{box, box, to(8, 6, 4), {}}, 0},  // corner on corner
      {{box, box, to(8, 6, 0), {}}, 0},  // edge on edge
      {{rigid::Sphere{1}, drum, {}, {}}, -3},
      {{rigid::Sphere{1}, egg, {}, {}}, -3},
      {{rigid::Sphere{1}, prism(6, 4), {}, {}}, -2},
      {{drum, drum, {}, {}}, -4},
      {{drum, box, {}, {}}, -5},
      {{egg, egg, {}, {}}, -4},
      {{egg, unit, {}, {}}, -3},
      {{unit, unit, {}, {}}, -2},
      {{prism(6, 4), prism(6, 4), {}, {}}, -2},
      {{rigid::Capsule{1, 2}, drum, {}, {}}, -3},
      {{egg, drum, {}, {}}, -4}};
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Points points = at(poses[i].first);
    ASSERT_FALSE(points.empty()) << i;
    for (const auto& p : points) EXPECT_NEAR(p.normal.norm(), 1, 1e-14) << i;
    // a sphere's or capsule's depth is the closest way out of the core plus the radii
    EXPECT_NEAR(deepest(points).gap, poses[i].second, 1e-9) << i;
    EXPECT_NEAR(support_gap(poses[i].first, deepest(points).normal), poses[i].second, 1e-9) << i;
  }
}

TEST_P(ConvexPatches, ThinEllipsoids) {
  std::mt19937_64 random(9);
  for (int i = 0; i < 40; ++i) {
    const Vec3 half = i % 2 ? Vec3(1, 10, 10) : Vec3(1, 1, 10);
    Pair p{rigid::Ellipsoid{half}, rigid::Ellipsoid{half}, {Vec3::Zero(), random_orientation(random)}, {}};
    p.pose_b = {Vec3(0, 0, 30), random_orientation(random)};
    for (const double gap : {0.3, 1e-8, -1e-8, -0.05}) {
      const ReferenceGap far = reference_gap(p);
      p.pose_b.position += (gap - far.gap) * far.normal;
      const Points points = at(p);
      ASSERT_EQ(points.size(), 1u);
      EXPECT_NEAR(points[0].gap, gap, 1e-9) << i;
      EXPECT_LE((points[0].normal - far.normal).norm(), 1e-5) << i;
    }
  }
}

/// The normal of an ellipsoid that touches another with the same axes is known.
TEST_P(ConvexPatches, TheNormalOfCurvedPairsIsExact) {
  std::mt19937_64 random(11);
  for (int i = 0; i < 100; ++i) {
    const Vec3 n = random_direction(random);
    const rigid::Ellipsoid a{{2, 3, 5}}, b{{4, 1.5, 3}};
    for (const double gap : {0.2, 1e-3, 0.0, -1e-3, -0.2}) {
      const Vec3 centre = rigid::support(ConvexShape(a), n) + gap * n - rigid::support(ConvexShape(b), -n);
      const Points points = at({a, b, {}, {centre, Quat::Identity()}});
      ASSERT_EQ(points.size(), 1u);
      EXPECT_NEAR(points[0].gap, gap, 1e-12);
      EXPECT_LE((points[0].normal - n).norm(), 1e-9) << gap;
      EXPECT_LE((points[0].on_a - rigid::support(ConvexShape(a), n)).norm(), 1e-8) << gap;
    }
  }
}

TEST_P(ConvexPatches, FeaturesStayUnderSmallMotions) {
  std::mt19937_64 random(3);
  const Quat lying = turned(90, Vec3::UnitX());
  struct Resting {
    Pair pair;
    std::size_t more =
        0;  // the deepest rim point comes and goes with the tilt: it is on top of the fixed ones
  };
  const std::vector<Resting> resting = {
      {stacked_boxes({2, 1, 2}, {1, 1, 0}, 10, -0.01)},
      {stacked_boxes({3.5, 3.5, 2}, {0.1, 0.2, 0}, 45, -0.01)},
      {{rigid::Capsule{2, 3}, rigid::Box{{4, 4, 2}}, at_height(2, turned(89, Vec3::UnitX())), at_height(-2)}},
      {{rigid::Box{{4, 3, 2}}, floor_, {}, at_height(-2)}},
      {{rigid::Sphere{3}, rigid::Box{{4, 3, 2}}, {}, at_height(-5)}},
      {{prism(6, 3), prism(4, 5), at_height(2), at_height(0, turned(7, Vec3::UnitZ()))}, 1},
      {{prism(6, 3), floor_, at_height(1), {}}, 1},
      {{drum, rigid::Box{{4, 4, 2}}, at_height(5), at_height(0, turned(11, Vec3::UnitZ()))}, 1},
      {{drum, rigid::Box{{9, 9, 1}}, at_height(3, lying), {}}, 1},
      {{rigid::Ellipsoid{{2, 3, 4}}, rigid::Box{{9, 9, 1}}, at_height(5), {}}, 1}};
  const auto ids = [](const Points& points) {
    std::set<std::uint32_t> all;
    for (const auto& p : points) all.insert(p.feature);
    return all;
  };
  for (std::size_t r = 0; r < resting.size(); ++r) {
    const auto before = ids(at(resting[r].pair));
    for (int i = 0; i < 20; ++i) {
      Pair moved = resting[r].pair;
      moved.pose_b.position += 1e-3 * random_direction(random);
      moved.pose_b.orientation = turned(0.01, random_direction(random)) * moved.pose_b.orientation;
      const auto after = ids(at(moved));
      EXPECT_TRUE(std::includes(after.begin(), after.end(), before.begin(), before.end())) << r;
      EXPECT_LE(after.size(), before.size() + resting[r].more) << r;
    }
  }
}

TEST_P(ConvexPatches, TheDeepestPointSurvivesReduction) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 50; ++i) {
    const Pair p{drum, rigid::Cylinder{3, 2}, at_height(5, turned(0.5, random_direction(random))),
                 at_height(0, turned(7.0 * i, Vec3::UnitZ()))};
    Points points = at(p, 2);
    const double gap = deepest(points).gap;
    rigid::reduce_manifold(points);
    EXPECT_LE(points.size(), rigid::most_contact_points);
    EXPECT_EQ(deepest(points).gap, gap);
  }
}

INSTANTIATE_TEST_SUITE_P(Backends, ConvexPatches, testing::ValuesIn(every_backend()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace silt::tests

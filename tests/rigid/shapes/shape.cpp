// Every convex shape: rays, supports, boxes, reaches and inner balls.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "rigid/math/types.hpp"
#include "rigid/shapes/shape.hpp"
#include "tests/ray_distance.hpp"
#include "tests/rigid/random.hpp"
#include "tests/shape_rows.hpp"

namespace silt::rigid {
namespace {

using testing::random_turn;
using testing::uniform;

Vec3 random_vector(double size) {
  return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
}

using tests::all_solids;
using tests::ray_distance;

TEST(Shape, HasARowOfTheTestsTable) {
  const auto expect_rows = []<class... S>(const std::variant<S...>*) {
    for (const std::string_view name : {S::name...})
      if (name != HalfSpace::name) {
        EXPECT_FALSE(tests::row_of(name).solids.empty()) << name;
      }
  };
  expect_rows(static_cast<const ConvexShape*>(nullptr));
}

std::vector<Shape> solids() {
  Compound star;
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
    star.parts.push_back({Capsule{0.3, 1.1}, {Vec3::Zero(), rotation_between(Vec3::UnitZ(), axis)}});
  Compound mixed{{{Box{{1, 0.4, 0.3}}, {{0.2, 0, 0}, random_turn()}},
                  {Sphere{0.7}, {{-0.9, 0.1, 0}, Quat::Identity()}},
                  {Capsule{0.25, 0.8}, {{0, 0.5, 0.2}, random_turn()}}}};
  Compound every;
  for (const tests::ShapeRow& row : tests::shape_rows())
    every.parts.push_back({row.solids[0], {random_vector(0.6), random_turn()}});
  std::vector<Shape> all = {star, every, mixed};
  for (const ConvexShape& shape : all_solids()) all.insert(all.begin(), shape);
  return all;
}

TEST(Shape, ClosedForms) {
  EXPECT_DOUBLE_EQ(signed_distance(Box{{1, 2, 3}}, {2, 3, 0}), std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(signed_distance(Box{{1, 2, 3}}, {0.5, 0, 0}), -0.5);
  EXPECT_DOUBLE_EQ(signed_distance(Capsule{0.5, 1}, {0, 0, 2}), 0.5);
  EXPECT_DOUBLE_EQ(signed_distance(Capsule{0.5, 1}, {2, 0, 0.7}), 1.5);
  EXPECT_DOUBLE_EQ(signed_distance(HalfSpace{Vec3::UnitZ()}, {3, 4, -5}), -5);
  EXPECT_DOUBLE_EQ(signed_distance(Cylinder{0.5, 1}, {3.5, 0, 5}), 5);
  EXPECT_DOUBLE_EQ(signed_distance(Cylinder{0.5, 1}, {0, 0.3, 0.9}), -0.1);
  EXPECT_DOUBLE_EQ(signed_distance(Ellipsoid{{1, 2, 3}}, {0, 0, 5}), 2);
  EXPECT_DOUBLE_EQ(signed_distance(Ellipsoid{{1, 2, 3}}, {0, 0, 0}), -1);
  EXPECT_DOUBLE_EQ(signed_distance(testing::cuboid({-1, -2, -3}, {1, 2, 3}), {2, 3, 0}), std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(signed_distance(testing::cuboid({-1, -2, -3}, {1, 2, 3}), {2, 3, 4}), std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(ray_distance(Cylinder{0.5, 1}, {0.2, 0, 4}, {0, 0, -2}, 10), 1.5);
  EXPECT_DOUBLE_EQ(ray_distance(Cylinder{0.5, 1}, {3, 0, 0.9}, {-1, 0, 0}, 10), 2.5);
  EXPECT_EQ(ray_distance(Cylinder{0.5, 1}, {3, 0, 1.1}, {-1, 0, 0}, 10), 10);
  EXPECT_DOUBLE_EQ(ray_distance(Ellipsoid{{1, 2, 3}}, {0, 0, 8}, {0, 0, -1}, 10), 5);
  EXPECT_DOUBLE_EQ(ray_distance(testing::octahedron({1, 1, 1}), {1, 1, 1}, {-1, -1, -1}, 10), 2.0 / 3);
  EXPECT_DOUBLE_EQ(ray_distance(Sphere{1}, {-3, 0, 0}, {2, 0, 0}, 10), 1);
  EXPECT_EQ(ray_distance(Sphere{1}, {-3, 0, 0}, {-2, 0, 0}, 10), 10);
  EXPECT_DOUBLE_EQ(ray_distance(Box{{1, 1, 1}}, {0.2, -4, 0.3}, {0, 1, 0}, 10), 3);
  EXPECT_EQ(ray_distance(Box{{1, 1, 1}}, {1.2, -4, 0.3}, {0, 1, 0}, 10), 10);
  EXPECT_DOUBLE_EQ(ray_distance(Capsule{0.5, 1}, {0, 0, 4}, {0, 0, -1}, 10), 2.5);
  EXPECT_DOUBLE_EQ(ray_distance(HalfSpace{Vec3::UnitZ()}, {0, 0, 4}, {0, 1, -2}, 10), 2);
  EXPECT_EQ(shape_name(Compound{}), "compound");
  EXPECT_EQ(shape_name(HalfSpace{Vec3::UnitX()}), "half-space");
  EXPECT_DOUBLE_EQ(bounding_radius(Box{{1, 2, 2}}), 3);
  EXPECT_DOUBLE_EQ(bounding_radius(Compound{{{Capsule{0.5, 1}, {{1, 0, 0}, Quat::Identity()}}}}),
                   0.5 + std::sqrt(2.0));
  EXPECT_TRUE(is_sphere(Sphere{1}));
  EXPECT_FALSE(is_sphere(Capsule{1, 0.1}));
  EXPECT_THROW(mass_properties(HalfSpace{Vec3::UnitX()}), std::invalid_argument);
}

TEST(Shape, RayHitsTheSurfaceAndNothingBefore) {
  for (const Shape& shape : solids())
    for (int i = 0; i < 2000; ++i) {
      const Vec3 origin = random_vector(4), direction = random_vector(1);
      if (contains(shape, origin)) continue;
      const double t = ray_distance(shape, origin, direction, 20);
      if (t < 20) {
        EXPECT_NEAR(signed_distance(shape, origin + t * direction), 0, 1e-12) << shape_name(shape);
      }
      for (int k = 1; k < 20; ++k)
        EXPECT_GT(signed_distance(shape, origin + t * (k / 20.0) * direction), -1e-12) << shape_name(shape);
    }
}

TEST(Shape,
     DistanceIsHowFarASphereTracerMayGo) {  // |d(x) - d(y)| <= |x - y|, and the nearest surface is that far
  for (const Shape& shape : solids())
    for (int i = 0; i < 1000; ++i) {
      const Vec3 x = random_vector(3), y = x + random_vector(0.3);
      EXPECT_LE(std::abs(signed_distance(shape, x) - signed_distance(shape, y)), (x - y).norm() + 1e-12);
      EXPECT_EQ(contains(shape, x), signed_distance(shape, x) <= 0);
      const double d = signed_distance(shape, x);
      if (d > 0) {
        EXPECT_GE(ray_distance(shape, x, random_vector(1).normalized(), 100), d - 1e-12);
      }
    }
}

TEST(Shape, BoxAndSupportAgree) {
  for (const Shape& shape : solids())
    for (int i = 0; i < 200; ++i) {
      const Pose pose{random_vector(5), random_turn()};
      const BoundingBox box = bounding_box(shape, pose);
      BoundingBox tight{Vec3::Constant(1e9), Vec3::Constant(-1e9)};
      double furthest = 0;
      for (const Part& part : convex_parts(shape)) {
        const Pose part_pose = pose * part.pose;
        for (int d = 0; d < 3; ++d)
          for (double sign : {-1.0, 1.0}) {
            const Vec3 x = part_pose.to_world(
                support(part.shape, part_pose.orientation.conjugate() * (sign * Vec3::Unit(d))));
            tight.lower = tight.lower.cwiseMin(x);
            tight.upper = tight.upper.cwiseMax(x);
            furthest = std::max(furthest, (x - pose.position).norm());
            EXPECT_NEAR(signed_distance(shape, pose.to_body(x)) > 1e-12, false, 0);
          }
      }
      EXPECT_NEAR((tight.lower - box.lower).cwiseAbs().maxCoeff(), 0, 1e-12) << shape_name(shape);
      EXPECT_NEAR((tight.upper - box.upper).cwiseAbs().maxCoeff(), 0, 1e-12) << shape_name(shape);
      EXPECT_LE(furthest, bounding_radius(shape) + 1e-12);
    }
}

TEST(Shape, SupportIsFurthest) {
  for (const ConvexShape& shape : all_solids())
    for (int i = 0; i < 500; ++i) {
      const Vec3 d = random_vector(1), s = support(shape, d);
      const Shape solid = std::visit([](auto x) -> Shape { return x; }, shape);
      EXPECT_NEAR(signed_distance(solid, s), 0, 1e-12);
      const Vec3 x = random_vector(2.5);
      if (contains(solid, x)) {
        EXPECT_LE(d.dot(x), d.dot(s) + 1e-12);
      }
    }
}

/// n . x - h(n), h(n) how far the shape reaches along n. The signed distance of a convex shape is the largest
/// over all directions n, inside and outside (duality); nothing of the shape is looked at but `support`.
double height_along(const ConvexShape& shape, const Vec3& x, const Vec3& n) {
  return n.dot(x - support(shape, n));
}

double largest_height(const ConvexShape& shape, const Vec3& x) {
  const int directions = 4000;
  double best = -1e9;
  for (int i = 0; i < directions; ++i) {
    const double z = 1 - (2 * i + 1.) / directions, turn = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - z * z);
    best = std::max(best, height_along(shape, x, {r * std::cos(turn), r * std::sin(turn), z}));
  }
  return best;
}

/// Returns the gradient of the distance next to x: at x itself it may have a kink.
Vec3 gradient(const Shape& solid, const Vec3& x) {
  const Vec3 beside = x + random_vector(1e-7);
  Vec3 g;
  for (int d = 0; d < 3; ++d) {
    const Vec3 step = 1e-9 * Vec3::Unit(d);
    g[d] = signed_distance(solid, beside + step) - signed_distance(solid, beside - step);
  }
  return g.normalized();
}

TEST(Shape,
     DistanceIsTheOneToTheFurthestPlane) {  // none is further, and the one across the gradient is as far
  for (const ConvexShape& shape : all_solids())
    for (int i = 0; i < 60; ++i) {
      const Shape solid = std::visit([](auto s) -> Shape { return s; }, shape);
      Vec3 x = random_vector(i % 2 ? 1 : 2.5);
      if (i % 5 == 0) x = support(shape, random_vector(1)) * uniform(0.8, 1.2);  // close to the surface
      if (i % 7 == 0) x[i % 3] = 0;
      const double distance = signed_distance(solid, x);
      EXPECT_LE(largest_height(shape, x), distance + 1e-12) << shape_name(solid) << " at " << x.transpose();
      EXPECT_NEAR(height_along(shape, x, gradient(solid, x)), distance, 1e-6)
          << shape_name(solid) << " at " << x.transpose();
    }
}

/// From a point of the surface along its normal: outwards any way, inwards as far as a ball that touches
/// there touches nowhere else.
TEST(Shape, DistanceToAnEllipsoidIsTheWayAlongANormal) {
  for (int i = 0; i < 20000; ++i) {
    Vec3 axes;
    for (double& axis : axes) axis = std::pow(10, uniform(0, 2));
    if (i % 4 == 0) axes[1] = axes[0];
    Vec3 normal = random_vector(1);
    if (i % 5 == 0) normal[i % 3] = 0;
    if (i % 7 == 0) normal[i % 2] = 0, normal[2] = 0;
    if (normal.isZero(0)) continue;
    normal.normalize();
    const double least_radius = axes.minCoeff() * axes.minCoeff() / axes.maxCoeff();  // of curvature
    const double distance =
        i % 2 ? -least_radius * uniform(0, 1) : axes.maxCoeff() * std::pow(10, uniform(-6, 1));
    const Ellipsoid ellipsoid{axes};
    const Vec3 x = ellipsoid.support(normal) + distance * normal;
    EXPECT_NEAR(signed_distance(ellipsoid, x), distance, 1e-14 * (axes.maxCoeff() + std::abs(distance)))
        << axes.transpose() << " at " << x.transpose();
    EXPECT_EQ(distance <= 0, contains(ellipsoid, x));
  }
}

TEST(Shape, DistanceToADiscSeenAlongItsAxis) {  // the ellipse (cos, 100 sin): on the axes in closed form
  const double a = 100, c = 1;
  for (const double x :
       {0.0, 10.0, 50.0, 99.98, 99.995}) {  // inside on the long axis, to either side of the focus
    const double focal = (a * a - c * c) / a;
    const double exact = x < focal ? c * std::sqrt(1 - x * x / (a * a - c * c)) : a - x;
    EXPECT_NEAR(signed_distance(Ellipsoid{{a, a, c}}, {x, 0, 0}), -exact, 1e-13 * a) << x;
    EXPECT_NEAR(signed_distance(Ellipsoid{{c, c, a}}, {0, 0, x}), -exact, 1e-13 * a) << x;
  }
}

TEST(Shape, ReachIsThatOfTheFurthestPoint) {
  for (const ConvexShape& shape : all_solids())
    for (int i = 0; i < 40; ++i) {
      const Part part{shape,
                      {i % 4 ? random_vector(2) : Vec3(0, 0, 0), i % 3 ? random_turn() : Quat(1, 0, 0, 0)}};
      double furthest = 0;
      Vec3 n = random_vector(1);
      for (int start = 0; start < 300; ++start, n = random_vector(1))
        for (int k = 0; k < 20; ++k) {  // the point furthest along the way to the last one is further still
          const Vec3 x = part.pose.to_world(support(shape, part.pose.orientation.conjugate() * n));
          furthest = std::max(furthest, x.norm());
          n = x;
        }
      EXPECT_NEAR(reach(part), furthest, 1e-6) << shape_name(shape);
      EXPECT_GE(reach(part), furthest - 1e-14);
    }
}

TEST(Shape, RecentringMovesTheSolid) {
  const Vec3 c(0.3, -0.2, 0.5);
  for (const Shape& shape : {solids().back(), Shape(testing::frustum())}) {
    const Shape moved = recentred(shape, c);
    for (int i = 0; i < 100; ++i) {
      const Vec3 x = random_vector(2);
      EXPECT_NEAR(signed_distance(shape, x), signed_distance(moved, x - c), 1e-13);
    }
  }
}

TEST(Shape, ScalingIsThatOfAllLengths) {
  auto shapes = solids();
  shapes.push_back(Shape(testing::frustum()));
  for (const Shape& shape : shapes) {
    const Shape twice = scaled(shape, 2);
    EXPECT_NEAR(mass_properties(twice).volume, 8 * mass_properties(shape).volume,
                1e-4 * mass_properties(twice).volume);
    EXPECT_NEAR(bounding_radius(twice), 2 * bounding_radius(shape), 1e-12);
    for (int i = 0; i < 100; ++i) {
      const Vec3 x = random_vector(2);
      EXPECT_NEAR(signed_distance(twice, 2 * x), 2 * signed_distance(shape, x), 1e-9) << shape_name(shape);
    }
  }
}

TEST(Shape, InnerBallsLieInside) {
  for (const Shape& shape : solids())
    for (const Part& part : convex_parts(shape)) {
      std::vector<InnerBall> balls;
      std::visit([&](const auto& solid) { solid.add_inner_balls(balls); }, part.shape);
      EXPECT_FALSE(balls.empty());
      for (const InnerBall& ball : balls)
        EXPECT_LE(signed_distance(part.shape, ball.centre) + ball.radius, 1e-12) << shape_name(part.shape);
    }
}

}  // namespace
}  // namespace silt::rigid

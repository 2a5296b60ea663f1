// Shapes: closed forms, and properties that must hold for any pose and ray.
#include "rigid/shape.hpp"

#include <gtest/gtest.h>

#include <random>

#include "rigid/ray_interval.hpp"

namespace silt::rigid {
namespace {

std::mt19937 generator(7);
double uniform(double a, double b) {
  return std::uniform_real_distribution<>(a, b)(generator);
}
Vec3 random_vector(double size) {
  return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
}
Quat random_turn() {
  return Quat(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)).normalized();
}

std::vector<Shape> solids() {
  Compound star;
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
    star.parts.push_back({Capsule{0.3, 1.1}, {Vec3::Zero(), Quat::FromTwoVectors(Vec3::UnitZ(), axis)}});
  Compound mixed{{{Box{{1, 0.4, 0.3}}, {{0.2, 0, 0}, random_turn()}},
                  {Sphere{0.7}, {{-0.9, 0.1, 0}, Quat::Identity()}},
                  {Capsule{0.25, 0.8}, {{0, 0.5, 0.2}, random_turn()}}}};
  return {Sphere{1.3}, Box{{0.5, 1.1, 0.8}}, Capsule{0.6, 0.9}, star, mixed};
}

TEST(Shape, ClosedForms) {
  EXPECT_DOUBLE_EQ(signed_distance(Box{{1, 2, 3}}, {2, 3, 0}), std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(signed_distance(Box{{1, 2, 3}}, {0.5, 0, 0}), -0.5);
  EXPECT_DOUBLE_EQ(signed_distance(Capsule{0.5, 1}, {0, 0, 2}), 0.5);
  EXPECT_DOUBLE_EQ(signed_distance(Capsule{0.5, 1}, {2, 0, 0.7}), 1.5);
  EXPECT_DOUBLE_EQ(signed_distance(HalfSpace{Vec3::UnitZ()}, {3, 4, -5}), -5);
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
  for (const ConvexShape& shape :
       {ConvexShape(Sphere{1.3}), ConvexShape(Box{{0.5, 1.1, 0.8}}), ConvexShape(Capsule{0.6, 0.9})})
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

TEST(Shape, RecentringMovesPartsOnly) {
  const Shape shape = solids().back();
  const Vec3 c(0.3, -0.2, 0.5);
  const Shape moved = recentred(shape, c);
  for (int i = 0; i < 100; ++i) {
    const Vec3 x = random_vector(2);
    EXPECT_NEAR(signed_distance(shape, x), signed_distance(moved, x - c), 1e-13);
  }
}

}  // namespace
}  // namespace silt::rigid

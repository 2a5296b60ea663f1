// Hulls by qhull: which points are corners, that flat faces are whole, and what is refused.
#include "adapters/qhull/convex_hull.hpp"

#include <gtest/gtest.h>

#include <random>

#include "rigid/shapes/shape.hpp"

namespace silt::adapters {
namespace {

using rigid::Vec3;

std::vector<Vec3> cube(double scale = 1, const Vec3& at = Vec3::Zero(),
                       const rigid::Quat& turn = {1, 0, 0, 0}) {
  std::vector<Vec3> points;
  for (int i = 0; i < 8; ++i) points.push_back(at + scale * (turn * Vec3(i & 1, i >> 1 & 1, i >> 2 & 1)));
  return points;
}

TEST(ConvexHull, FacesOfACubeAreWholeAtAnySizeAndPlace) {
  const rigid::Quat turn = rigid::Quat(0.3, 0.5, -0.2, 0.7).normalized();
  for (const double scale : {1e-6, 1.0, 1e6})
    for (const bool turned : {false, true}) {
      const auto points = cube(scale, scale * Vec3(3, -2, 5), turned ? turn : rigid::Quat(1, 0, 0, 0));
      const auto hull = convex_hull(points);
      EXPECT_EQ(hull.mesh->faces.size(), 6u);
      EXPECT_EQ(hull.mesh->edges.size(), 12u);
      EXPECT_EQ(hull.corners, (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7}));
      EXPECT_NEAR(rigid::integrals(*hull.mesh).volume / (scale * scale * scale), 1, 1e-12);
    }
}

TEST(ConvexHull, PointsInsideOnFacesOnEdgesAndTwiceAreNoCorners) {
  auto points = cube();
  points.insert(points.begin(), Vec3(0.5, 0.5, 0.5));
  points.push_back({0.5, 0.5, 1});
  points.push_back({0.5, 0, 1});
  points.push_back({1, 1, 1});
  const auto hull = convex_hull(points);
  EXPECT_EQ(hull.mesh->vertices.size(), 8u);
  EXPECT_EQ(hull.mesh->faces.size(), 6u);
  EXPECT_EQ(hull.corners[0], 1);
}

TEST(ConvexHull, HoldsRandomPointsAndNothingItNeedNot) {
  std::mt19937_64 generator(5);
  std::normal_distribution<> normal;
  for (const int n : {4, 5, 10, 100, 1000}) {
    std::vector<Vec3> points;
    for (int i = 0; i < n; ++i)
      points.push_back(Vec3(normal(generator), normal(generator), normal(generator)));
    const auto hull = convex_hull(points);
    const rigid::Polyhedron solid{hull.mesh};
    for (const Vec3& p : points) EXPECT_LT(rigid::signed_distance(solid, p), 1e-5);
    for (std::size_t k = 0; k < hull.corners.size(); ++k)
      EXPECT_EQ(hull.mesh->vertices[k], points[hull.corners[k]]) << "corners are given points, not moved";
    for (int i = 0; i < 100; ++i) {  // along any direction it reaches as far as the points do
      const Vec3 d(normal(generator), normal(generator), normal(generator));
      double furthest = -1e9;
      for (const Vec3& p : points) furthest = std::max(furthest, p.dot(d));
      EXPECT_NEAR(rigid::support(solid, d).dot(d), furthest, 1e-5 * d.norm());
    }
  }
}

TEST(ConvexHull, ManyCornersOfASphere) {
  std::vector<Vec3> points;
  const int n = 2000;
  for (int i = 0; i < n; ++i) {
    const double z = 1 - (2 * i + 1.) / n, turn = i * M_PI * (3 - std::sqrt(5.0)), r = std::sqrt(1 - z * z);
    points.push_back({r * std::cos(turn), r * std::sin(turn), z});
  }
  const auto hull = convex_hull(points);
  EXPECT_EQ(hull.corners.size(), points.size());
  EXPECT_NEAR(rigid::integrals(*hull.mesh).volume, 4 * M_PI / 3, 0.02);
}

std::string refusal(const std::vector<Vec3>& points) {
  try {
    convex_hull(points);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(ConvexHull, RefusesWhatEnclosesNothing) {
  EXPECT_EQ(refusal({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), "a convex hull needs at least 4 points, there are 3");
  EXPECT_EQ(refusal({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, NAN, 1}}), "point 3 is not finite");
  EXPECT_EQ(refusal(std::vector<Vec3>(5, Vec3(1, 2, 3))), "all points are the same");
  const std::string flat = "all points lie in one plane, or nearly: they enclose no volume";
  EXPECT_EQ(refusal({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}), flat);
  EXPECT_EQ(refusal({{0, 0, 0}, {1, 0, 1}, {0, 1, 1}, {1, 1, 2}, {3, 2, 5}}), flat);
  EXPECT_EQ(refusal({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1e-7}}), flat);
}

}  // namespace
}  // namespace silt::adapters

// Polyhedra from STL files, and convex hulls of points.
#include <gtest/gtest.h>

#include <random>
#include <stdexcept>
#include <string>

#include "adapters/mesh/read_mesh.hpp"
#include "adapters/qhull/convex_hull.hpp"
#include "rigid/shapes/shape.hpp"
#include "tests/adapters/mesh_texts.hpp"
#include "tests/errors.hpp"

namespace silt::adapters {
namespace {

using rigid::Vec3;
using tests::cube_facets;
using tests::Facet;
using tests::stl_binary;
using tests::stl_text;

std::string refusal(const std::string& bytes) {
  return tests::error_of<std::invalid_argument>([&] { read_polyhedron("a.stl", bytes, 1); });
}

TEST(ReadPolyhedron, TextAndBinaryGiveTheSameBody) {
  const rigid::Quat turn = rigid::Quat(0.3, 0.5, -0.2, 0.7).normalized();
  const auto turned = cube_facets([&](const Vec3& x) -> Vec3 { return turn * x + Vec3(5, 6, 7); });
  for (const std::string& bytes :
       {stl_text(cube_facets()), stl_binary(cube_facets()), stl_binary(cube_facets(), "solid but binary"),
        stl_text(turned), stl_binary(turned)}) {
    const auto mesh = read_polyhedron("a.stl", bytes, 2).mesh;
    EXPECT_EQ(mesh->vertices.size(), 8u);
    EXPECT_EQ(mesh->faces.size(), 6u) << "two triangles a face, put together";
    EXPECT_NEAR(rigid::integrals(*mesh).volume, 8, 1e-5);
  }
  EXPECT_EQ(stl_triangles(stl_text(cube_facets())).points, stl_triangles(stl_binary(cube_facets())).points);
}

TEST(ReadPolyhedron, CornersAreWeldedAndTurnedOverBodiesTaken) {
  auto shaken = cube_facets();
  for (std::size_t t = 0; t < shaken.size(); ++t)
    for (int k = 0; k < 3; ++k) shaken[t][k][(t + k) % 3] += 1e-7 * ((t * k) % 3);
  EXPECT_EQ(read_polyhedron("a.stl", stl_text(shaken), 1).mesh->vertices.size(), 8u);
  auto inside_out = cube_facets();
  for (Facet& t : inside_out) std::swap(t[0], t[1]);
  EXPECT_EQ(read_polyhedron("a.stl", stl_text(inside_out), 1).mesh->faces.size(), 6u);
  auto turned = cube_facets();
  std::swap(turned[3][0], turned[3][1]);
  EXPECT_EQ(read_polyhedron("a.stl", stl_text(turned), 1).mesh->faces.size(), 6u);
  auto sliver = cube_facets();  // a triangle without area, between two that meet along its edge
  sliver.push_back({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 0, 0)});
  EXPECT_EQ(read_polyhedron("a.stl", stl_text(sliver), 1).mesh->faces.size(), 6u);
}

TEST(ReadPolyhedron, SaysWhatIsWrongWithTheSurface) {
  auto open = cube_facets();
  open.pop_back();
  EXPECT_EQ(refusal(stl_text(open)),
            "the surface is not closed: it ends at 3 edges, the first from [0, 0, 1] to [0, 1, 1]; close its "
            "holes, and merge corners that should be one");
  EXPECT_EQ(refusal(stl_text({cube_facets()[0]})), "it has 1 triangles; a closed surface has at least 4");
  // the top drawn down to a point below its middle: a dent of a pyramid, 1/3 x 1/2
  auto dented = cube_facets();
  dented.resize(10);
  const Vec3 tip(0.5, 0.5, 0.5), a(0, 0, 1), b(1, 0, 1), c(1, 1, 1), d(0, 1, 1);
  for (const auto& [p, q] : {std::pair{a, b}, {b, c}, {c, d}, {d, a}}) dented.push_back({p, q, tip});
  EXPECT_EQ(refusal(stl_binary(dented)),
            "the surface is not convex: it encloses 0.833333 of the volume of its hull; make the shape a "
            "mesh, or cut the body into convex pieces, one file each, and put them together as a compound");
  const Vec3 o(0, 0, 0), x(1, 0, 0), y(0, 1, 0), pressed(0.3, 0.3, 0);
  EXPECT_EQ(refusal(stl_text({{o, y, x}, {o, x, pressed}, {x, y, pressed}, {y, o, pressed}})),
            "the shell at [0, 0, 0] encloses no volume");
  auto two = cube_facets();
  const auto other = cube_facets([](const Vec3& x) -> Vec3 { return x + Vec3(3, 0, 0); });
  two.insert(two.end(), other.begin(), other.end());
  EXPECT_TRUE(refusal(stl_text(two)).starts_with("the surface is not convex: it encloses 0.5 of the volume"))
      << refusal(stl_text(two));
}

/// The needle's triangles run 1e-3 of its length across: flat faces are flat to 1e-6 of the thickness.
TEST(ReadPolyhedron, ANeedleKeepsItsVolume) {
  const rigid::Quat turn = rigid::Quat(0.3, 0.5, -0.2, 0.7).normalized();
  const auto needle =
      cube_facets([&](const Vec3& x) -> Vec3 { return turn * Vec3(x[0], 0.001 * x[1], 0.001 * x[2]); });
  EXPECT_NEAR(rigid::integrals(*read_polyhedron("a.stl", stl_text(needle), 1).mesh).volume, 1e-6, 1e-10);
  EXPECT_NEAR(rigid::integrals(*read_polyhedron("a.stl", stl_binary(needle), 1).mesh).volume, 1e-6, 1e-9);
}

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
  return tests::error_of<std::invalid_argument>([&] { convex_hull(points); });
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

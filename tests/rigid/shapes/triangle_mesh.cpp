// Meshes against what is known otherwise: closed forms, searches over all triangles, and whole numbers.
#include "rigid/shapes/triangle_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>

#include "rigid/math/types.hpp"
#include "rigid/shapes/shape.hpp"
#include "tests/ray_distance.hpp"
#include "tests/rigid/random.hpp"
#include "tests/rigid/shapes/meshes.hpp"

namespace silt::rigid {
namespace {

using testing::cuboid_mesh;
using testing::gear_mesh;
using testing::icosphere;
using testing::torus_mesh;

using testing::uniform;

Vec3 random_point(double reach) {
  return {uniform(-reach, reach), uniform(-reach, reach), uniform(-reach, reach)};
}

double distance_to_torus(const Vec3& x, double radius, double tube) {
  return std::hypot(std::hypot(x[0], x[1]) - radius, x[2]) - tube;
}

/// Returns the surface with its corners on a grid of 1 / units.
TriangleMesh on_grid(const TriangleMesh& mesh, double units, const Vec3& from) {
  std::vector<Vec3> corners(mesh.vertices().begin(), mesh.vertices().end());
  for (Vec3& x : corners) x = ((x + from) * units).array().round().matrix() / units;
  return {corners, {mesh.triangles().begin(), mesh.triangles().end()}};
}

__extension__ using Whole = __int128;

/// Volume, centre and inertia in whole numbers: tetrahedra from the origin, wherever that is. Corners must be
/// on the grid.
MassProperties exact_mass(const TriangleMesh& mesh, double units) {
  Whole volume = 0, first[3] = {}, second[3][3] = {};  // 6, 24 and 120 times
  for (std::uint32_t t = 0; t < mesh.triangles().size(); ++t) {
    Whole x[3][3], s[3];
    for (int k = 0; k < 3; ++k)
      for (int d = 0; d < 3; ++d) x[k][d] = Whole(mesh.corners(t)[k][d] * units);
    for (int d = 0; d < 3; ++d) s[d] = x[0][d] + x[1][d] + x[2][d];
    Whole v = 0;
    for (int d = 0; d < 3; ++d) {
      const int e = (d + 1) % 3, f = (d + 2) % 3;
      v += x[0][d] * (x[1][e] * x[2][f] - x[1][f] * x[2][e]);
    }
    volume += v;
    for (int d = 0; d < 3; ++d) {
      first[d] += v * s[d];
      for (int e = 0; e < 3; ++e)
        second[d][e] += v * (x[0][d] * x[0][e] + x[1][d] * x[1][e] + x[2][d] * x[2][e] + s[d] * s[e]);
    }
  }
#if defined(__SIZEOF_FLOAT128__)
  using Real = __float128;
#else
  using Real = long double;  // of 113 bits where there is no __float128
  static_assert(std::numeric_limits<Real>::digits >= 113);
#endif
  const Real u = units, six = 6, v = Real(volume) / (six * u * u * u);
  Real centre[3], about[3][3];
  for (int d = 0; d < 3; ++d) centre[d] = Real(first[d]) / (24 * u * u * u * u) / v;
  for (int d = 0; d < 3; ++d)
    for (int e = 0; e < 3; ++e)
      about[d][e] = Real(second[d][e]) / (120 * u * u * u * u * u) - v * centre[d] * centre[e];
  MassProperties p;
  p.volume = double(v);
  for (int d = 0; d < 3; ++d) p.centre[d] = double(centre[d]);
  for (int d = 0; d < 3; ++d)
    for (int e = 0; e < 3; ++e)
      p.inertia(d, e) = double((d == e ? about[0][0] + about[1][1] + about[2][2] : Real(0)) - about[d][e]);
  return p;
}

TEST(TriangleMesh, VolumeCentreAndInertiaAreThoseOfTheExactPolyhedron) {
  constexpr double units = 65536;
  const Vec3 far(2, 1.5, -1);
  for (const TriangleMesh& mesh :
       {on_grid(cuboid_mesh({-1, -0.5, -0.25}, {1, 0.5, 0.25}), units, far),
        on_grid(torus_mesh(1, 0.3, 40, 24), units, far), on_grid(gear_mesh(20, 6), units, far),
        on_grid(gear_mesh(62, 51), units, far), on_grid(torus_mesh(1, 0.02, 300, 8), units, far)}) {
    const MassProperties exact = exact_mass(mesh, units), found = mesh.mass_properties();
    const double size = std::sqrt(exact.inertia.trace() / exact.volume);
    EXPECT_NEAR(found.volume, exact.volume, 1e-12 * exact.volume);
    EXPECT_LT((found.centre - exact.centre).norm(), 1e-12 * size);
    EXPECT_LT((found.inertia - exact.inertia).norm(), 1e-12 * exact.inertia.norm())
        << mesh.triangles().size() << " triangles";
  }
}

TEST(TriangleMesh, ACuboidHasItsClosedForms) {
  const TriangleMesh mesh = cuboid_mesh({1, 2, 3}, {3, 5, 4});
  const MassProperties p = mesh.mass_properties();
  EXPECT_NEAR(p.volume, 6, 1e-14);
  EXPECT_LT((p.centre - Vec3(2, 3.5, 3.5)).norm(), 1e-15);
  EXPECT_LT((p.inertia - Vec3(5, 2.5, 6.5).asDiagonal().toDenseMatrix()).norm(), 1e-13);
  const Shape solid = testing::solid_of(mesh), vessel = testing::vessel_of(mesh);
  for (int k = 0; k < 1000; ++k) {
    const Vec3 x = Vec3(2, 3.5, 3.5) + random_point(3);
    const Box box{{1, 1.5, 0.5}};
    const double distance = box.signed_distance(x - Vec3(2, 3.5, 3.5));
    EXPECT_NEAR(signed_distance(solid, x), distance, 1e-14);
    EXPECT_NEAR(signed_distance(vessel, x), -distance, 1e-14);
    EXPECT_EQ(contains(solid, x), distance < 0);
    EXPECT_EQ(contains(vessel, x), distance > 0);
  }
}

TEST(TriangleMesh, TheNearestPointIsThatOfASearchOverAll) {
  const TriangleMesh mesh = gear_mesh(7, 2);
  for (int k = 0; k < 300; ++k) {
    const Vec3 x = random_point(1.5);
    const auto found = mesh.nearest(x);
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t t = 0; t < mesh.triangles().size(); ++t) {  // a fine net of each triangle
      const auto [a, b, c] = mesh.corners(t);
      for (int i = 0; i <= 20; ++i)
        for (int j = 0; i + j <= 20; ++j)
          least = std::min(least, (a + i / 20.0 * (b - a) + j / 20.0 * (c - a) - x).norm());
    }
    EXPECT_LE(found.distance, least);
    EXPECT_GT(found.distance, least - 0.02);
    EXPECT_NEAR((found.point - x).norm(), found.distance, 1e-15);
    EXPECT_EQ(mesh.nearest(x, 0.99 * found.distance).distance, std::numeric_limits<double>::infinity());
    EXPECT_EQ(mesh.nearest(x, 1.01 * found.distance).triangle, found.triangle);
  }
}

TEST(TriangleMesh, OfEquallyNearTrianglesTheFirstIsFound) {
  const TriangleMesh mesh = cuboid_mesh({-1, -1, -1}, {1, 1, 1});
  for (const Vec3& x : {Vec3(2, 2, 2), Vec3(2, 2, 0.3), Vec3(2, 0.25, 0.25)}) {
    const auto found = mesh.nearest(x);
    for (std::uint32_t t = 0; t < found.triangle; ++t) {
      const auto [a, b, c] = mesh.corners(t);
      const TriangleMesh alone({a, b, c}, {{0, 1, 2}});
      EXPECT_GT(alone.nearest(x).distance, found.distance);
    }
  }
}

TEST(TriangleMesh, InsideIsWhereTheTorusIs) {
  constexpr double radius = 1, tube = 0.4;
  const TriangleMesh mesh = torus_mesh(radius, tube, 200, 100);
  int near = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vec3 x(uniform(-1.5, 1.5), uniform(-1.5, 1.5), uniform(-0.5, 0.5));
    const double distance = distance_to_torus(x, radius, tube);
    if (std::abs(distance) < 1e-3)
      ++near;
    else
      EXPECT_EQ(mesh.encloses(x), distance < 0) << x.transpose();
  }
  EXPECT_LT(near, 200);
}

/// A line through edges and corners alone: every one is counted once.
TEST(TriangleMesh, LinesThroughEdgesAndCornersAreCountedOnce) {
  std::vector<Vec3> corners;  // an octahedron that points along the axes
  for (int d = 0; d < 3; ++d)
    for (const int s : {-1, 1}) corners.push_back(s * 4.0 * Vec3::Unit(d));
  const TriangleMesh mesh(
      corners, {{1, 3, 5}, {3, 0, 5}, {0, 2, 5}, {2, 1, 5}, {3, 1, 4}, {0, 3, 4}, {2, 0, 4}, {1, 2, 4}});
  for (int z = -5; z <= 5; ++z)
    for (int y = -5; y <= 5; ++y)
      for (int x = -5; x <= 5; ++x) {
        const int norm = std::abs(x) + std::abs(y) + std::abs(z);
        if (norm != 4) {
          EXPECT_EQ(mesh.encloses(Vec3(x, y, z)), norm < 4) << x << ' ' << y << ' ' << z;
        }
      }
}

/// Copies of a cuboid that share faces: every point of a grid that has their corners is in one of them.
TEST(TriangleMesh, APointOnACommonFaceIsInOneOfTheTwo) {
  std::vector<TriangleMesh> cells;
  for (int k = 0; k < 8; ++k) {
    const Vec3 low(k & 1, k >> 1 & 1, k >> 2);
    cells.push_back(cuboid_mesh(low, low + Vec3(1, 1, 1)));
  }
  for (const Vec3& x :
       {Vec3(1, 1, 1), Vec3(1, 0.5, 0.5), Vec3(0.5, 1, 1), Vec3(1, 1, 0.25), Vec3(0.5, 0.5, 1)})
    EXPECT_EQ(std::count_if(cells.begin(), cells.end(), [&](const TriangleMesh& c) { return c.encloses(x); }),
              1)
        << x.transpose();
}

TEST(TriangleMesh, RaysHitWhatASearchOverAllFindsAndSlipThroughNoEdge) {
  const TriangleMesh ball = icosphere(1, 4);
  for (int k = 0; k < 5000; ++k) {
    const Vec3 to = k % 2 ? ball.vertices()[std::size_t(k) % ball.vertices().size()]
                          : Vec3(0.5 * (ball.corners(k % 5000)[0] + ball.corners(k % 5000)[1]));
    const auto hit = ball.first_hit(Vec3::Zero(), to, 2);
    ASSERT_TRUE(hit) << k;
    EXPECT_NEAR(hit->t, 1, 1e-12);
  }
  const TriangleMesh gear = gear_mesh(7, 2);
  int hits = 0;
  for (int k = 0; k < 500; ++k) {
    const Vec3 o = random_point(2), d = random_point(0.8) - o;
    const auto found = gear.first_hit(o, d, 10);
    double least = 10;
    for (std::uint32_t t = 0; t < gear.triangles().size(); ++t) {
      const auto [a, b, c] = gear.corners(t);
      Mat3 m;
      m << b - a, c - a, -d;
      const Vec3 s = m.inverse() * (o - a);
      if (s[0] >= 0 && s[1] >= 0 && s[0] + s[1] <= 1 && s[2] >= 0) least = std::min(least, s[2]);
    }
    hits += found.has_value();
    EXPECT_NEAR(found ? found->t : 10, least, 1e-9);
  }
  EXPECT_GT(hits, 100);
}

TEST(TriangleMesh, TheOrderOfTheFileDoesNotMatter) {
  std::mt19937 generator(5);
  const TriangleMesh mesh = gear_mesh(9, 2);
  std::vector<std::uint32_t> order(mesh.vertices().size());
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), generator);
  std::vector<Vec3> corners(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) corners[order[k]] = mesh.vertices()[k];
  testing::Triangles triangles(mesh.triangles().begin(), mesh.triangles().end());
  std::shuffle(triangles.begin(), triangles.end(), generator);
  for (auto& t : triangles) {
    for (auto& corner : t) corner = order[corner];
    std::rotate(t.begin(), t.begin() + generator() % 3, t.end());
  }
  const TriangleMesh shuffled(corners, triangles);
  EXPECT_TRUE(std::equal(mesh.vertices().begin(), mesh.vertices().end(), shuffled.vertices().begin()));
  EXPECT_TRUE(std::equal(mesh.triangles().begin(), mesh.triangles().end(), shuffled.triangles().begin()));
}

TEST(TriangleMesh, AShapeSaysWhatItsMeshDoes) {
  const Shape torus = testing::solid_of(torus_mesh(1, 0.25, 64, 32)),
              vessel = testing::vessel_of(torus_mesh(1, 0.25, 64, 32));
  EXPECT_EQ(shape_name(torus), "mesh");
  EXPECT_NEAR(bounding_radius(torus), 1.25, 1e-12);
  EXPECT_EQ(bounding_radius(vessel), std::numeric_limits<double>::infinity());
  EXPECT_EQ(bounding_box(vessel, {}).upper[0], std::numeric_limits<double>::infinity());
  EXPECT_TRUE(convex_parts(torus).empty());
  EXPECT_NEAR(least_width(torus), 0.5, 1e-12);
  EXPECT_THROW(mass_properties(vessel), std::invalid_argument);
  const Pose turned{{1, 2, 3}, rotation_between(Vec3::UnitZ(), Vec3::UnitX())};
  const BoundingBox box = bounding_box(torus, turned);
  EXPECT_LT((box.lower - Vec3(0.75, 0.75, 1.75)).norm(), 1e-12);
  EXPECT_LT((box.upper - Vec3(1.25, 3.25, 4.25)).norm(), 1e-12);
  const Shape moved = recentred(torus, {1, 0, 0});
  EXPECT_LT((mass_properties(moved).centre - Vec3(-1, 0, 0)).norm(), 1e-13);
  EXPECT_NEAR(tests::ray_distance(torus, {-3, 0, 0}, {2, 0, 0}, 10), 0.875, 1e-12);
  EXPECT_EQ(tests::ray_distance(torus, {-3, 0, 1}, {2, 0, 0}, 10), 10);
}

}  // namespace
}  // namespace silt::rigid

// Mass properties of solids, and polyhedra.
#include <gtest/gtest.h>

#include <chrono>
#include <numbers>
#include <random>
#include <set>

#include "rigid/math/types.hpp"
#include "rigid/rigid_step.hpp"
#include "rigid/shapes/polyhedron.hpp"
#include "rigid/shapes/shape.hpp"
#include "tests/errors.hpp"
#include "tests/rigid/shapes/solids.hpp"
#include "tests/shape_rows.hpp"

namespace silt::rigid {
namespace {

using std::numbers::pi;

constexpr double promised = 1e-4;

Quat z_to(const Vec3& axis) {
  return rotation_between(Vec3::UnitZ(), axis);
}

TEST(MassProperties, ClosedForms) {
  const auto box = mass_properties(Box{{0.5, 1, 1.5}});
  EXPECT_DOUBLE_EQ(box.volume, 6);
  EXPECT_DOUBLE_EQ(box.inertia(0, 0), 6.0 / 12 * (4 + 9));
  const auto sphere = mass_properties(Sphere{2});
  EXPECT_DOUBLE_EQ(sphere.volume, 32 * pi / 3);
  EXPECT_DOUBLE_EQ(sphere.inertia(2, 2), 0.4 * sphere.volume * 4);
  // a capsule between a sphere and, by Monte Carlo, its own definition
  const Capsule c{0.6, 0.9};
  std::mt19937_64 g(1);
  std::uniform_real_distribution<> u(-1.5, 1.5);
  double volume = 0, along = 0, across = 0;
  const int n = 2000000;
  for (int i = 0; i < n; ++i) {
    const Vec3 x(0.4 * u(g), 0.4 * u(g), u(g));
    if (!contains(c, x)) continue;
    volume += 1, along += x[0] * x[0] + x[1] * x[1], across += x[1] * x[1] + x[2] * x[2];
  }
  const double cell = 1.2 * 1.2 * 3 / n;
  const auto p = mass_properties(c);
  EXPECT_NEAR(volume * cell / p.volume, 1, 3e-3);
  EXPECT_NEAR(along * cell / p.inertia(2, 2), 1, 3e-3);
  EXPECT_NEAR(across * cell / p.inertia(0, 0), 1, 3e-3);
}

TEST(MassProperties, ApartPartsAddUpExactly) {
  const auto p = mass_properties(
      Compound{{{Sphere{1}, {{-2, 0, 0}, Quat::Identity()}}, {Sphere{1}, {{2, 0, 0}, Quat::Identity()}}}});
  const double v = 4 * pi / 3;
  EXPECT_NEAR(p.volume, 2 * v, 1e-14);
  EXPECT_NEAR(p.inertia(0, 0), 2 * 0.4 * v, 1e-13);
  EXPECT_NEAR(p.inertia(1, 1), 2 * v * (0.4 + 4), 1e-12);
  EXPECT_EQ(p.centre, Vec3::Zero());
}

TEST(MassProperties, TwoSpheresAndTheirLens) {
  const double r = 1.0;
  for (double d : {0.3, 1.0, 1.7}) {
    const auto p = mass_properties(Compound{
        {{Sphere{r}, {{0, 0, -d / 2}, Quat::Identity()}}, {Sphere{r}, {{0, 0, d / 2}, Quat::Identity()}}}});
    const double lens = pi * (4 * r + d) * (2 * r - d) * (2 * r - d) / 12;
    EXPECT_NEAR(p.volume / (8 * pi / 3 - lens) - 1, 0, promised / 5) << d;
    // about the axis: each half is a sphere cut at z = 0: integral of pi/2 rho^4 dz
    double axial = 0;
    const int n = 200000;
    const double h = (r + d / 2) / n;
    for (int i = 0; i < n; ++i) {
      const double z = (i + 0.5) * h, rho2 = r * r - (z - d / 2) * (z - d / 2);
      axial += pi / 2 * rho2 * rho2 * h;
    }
    EXPECT_NEAR(p.inertia(2, 2) / (2 * axial) - 1, 0, promised / 5) << d;
    EXPECT_EQ(p.centre, Vec3::Zero());
  }
}

TEST(MassProperties, BoxesFaceToFaceAndNested) {
  // half of the second lies in the first: a bar of length 3
  const auto p =
      mass_properties(Compound{{{Box{{1, 1, 1}}, {}}, {Box{{1, 1, 1}}, {{1, 0, 0}, Quat::Identity()}}}});
  EXPECT_NEAR(p.volume / 12 - 1, 0, promised);
  EXPECT_NEAR(p.centre[0], 0.5, promised);
  EXPECT_NEAR(p.inertia(0, 0) / (12.0 / 12 * 8) - 1, 0, promised);
  EXPECT_NEAR(p.inertia(1, 1) / (12.0 / 12 * (9 + 4)) - 1, 0, promised);
  const auto nested =
      mass_properties(Compound{{{Sphere{1}, {}}, {Sphere{0.4}, {{0.2, 0, 0}, Quat::Identity()}}}});
  EXPECT_NEAR(nested.volume / (4 * pi / 3) - 1, 0, promised / 5);
}

/// Integrates by rays on a grid: along them the intervals are integrated exactly, across them by the midpoint
/// rule.
MassProperties by_rays(const ConvexShape& shape) {
  const Shape solid = std::visit([](const auto& s) -> Shape { return s; }, shape);
  const BoundingBox box = bounding_box(solid, {});
  const int n = 400;
  const Vec3 cell = (box.upper - box.lower) / n;
  double volume = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double x = box.lower[0] + (i + 0.5) * cell[0], y = box.lower[1] + (j + 0.5) * cell[1];
      const auto z = line_interval(shape, {x, y, 0}, Vec3::UnitZ());
      if (!z) continue;
      const double l = cell[0] * cell[1] * (z->leave - z->enter), mean = 0.5 * (z->leave + z->enter);
      const double square = (z->leave * z->leave + z->leave * z->enter + z->enter * z->enter) / 3;
      volume += l;
      first += l * Vec3(x, y, mean);
      Mat3 m;
      m << x * x, x * y, x * mean, x * y, y * y, y * mean, x * mean, y * mean, square;
      second += l * m;
    }
  const Vec3 centre = first / volume;
  second -= volume * centre * centre.transpose();
  return {volume, centre, second.trace() * Mat3::Identity() - second};
}

TEST(MassProperties, OfEveryShapeAreThoseOfItsRays) {
  auto shapes = tests::all_solids();
  shapes.push_back(testing::cuboid({3, 4, 5}, {4, 6, 8}));
  for (const ConvexShape& shape : shapes) {
    const Shape solid = std::visit([](const auto& s) -> Shape { return s; }, shape);
    const MassProperties p = mass_properties(solid), q = by_rays(shape);
    const double across = 1e-3;  // a grid of 400 rays
    EXPECT_NEAR(p.volume / q.volume, 1, across) << shape_name(solid);
    EXPECT_LT((p.centre - q.centre).norm(), across) << shape_name(solid);
    EXPECT_LT((p.inertia - q.inertia).norm(), across * p.inertia.norm()) << shape_name(solid);
    const MassProperties moved = mass_properties(recentred(solid, p.centre));
    EXPECT_LT(moved.centre.norm(), 1e-14);
    EXPECT_LT((moved.inertia - p.inertia).norm(), 1e-13 * p.inertia.norm());
  }
}

TEST(MassProperties, ClosedFormsOfPolyhedra) {
  const auto cube = mass_properties(testing::cuboid({3, 4, 5}, {4, 6, 8}));
  const auto box = mass_properties(Box{{0.5, 1, 1.5}});
  EXPECT_NEAR(cube.volume, box.volume, 1e-14);
  EXPECT_LT((cube.centre - Vec3(3.5, 5, 6.5)).norm(), 1e-14);
  EXPECT_LT((cube.inertia - box.inertia).norm(), 1e-13);
  // the corner of a cube: volume a^3/6, moment about an edge a^5/30, so about the centre a^5/30 - V a^2/8
  const auto corner = mass_properties(testing::tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}));
  EXPECT_DOUBLE_EQ(corner.volume, 1.0 / 6);
  EXPECT_LT((corner.centre - Vec3::Constant(0.25)).norm(), 1e-15);
  EXPECT_NEAR(corner.inertia(0, 0), 1.0 / 30 - 1.0 / 48, 1e-16);
  EXPECT_NEAR(corner.inertia(0, 1), -(1.0 / 120 - 1.0 / 96), 1e-16);  // minus the integral of x y
  const auto regular = mass_properties(testing::octahedron({1, 1, 1}));
  EXPECT_NEAR(regular.inertia(2, 2), regular.volume / 5, 1e-15);
  EXPECT_EQ(regular.inertia(0, 0), regular.inertia(1, 1)) << "a regular one needs no gyroscopic term";
  EXPECT_EQ(regular.inertia(0, 1), 0);
}

TEST(MassProperties, CrossedCylindersAndTheSolidsOfSteinmetz) {
  const double r = 0.5, l = 1.4, one = 2 * pi * r * r * l;
  const Part x{Cylinder{r, l}, {Vec3::Zero(), z_to(Vec3::UnitX())}};
  const Part y{Cylinder{r, l}, {Vec3::Zero(), z_to(Vec3::UnitY())}}, z{Cylinder{r, l}, {}};
  const double two = 16.0 / 3 * r * r * r, three = 8 * (2 - std::sqrt(2.0)) * r * r * r;
  const auto cross = mass_properties(Compound{{x, y}}), star = mass_properties(Compound{{x, y, z}});
  EXPECT_NEAR(cross.volume / (2 * one - two) - 1, 0, promised / 5);
  EXPECT_NEAR(star.volume / (3 * one - 3 * two + three) - 1, 0, promised / 5);
  EXPECT_EQ(star.inertia(0, 0), star.inertia(2, 2));
  EXPECT_EQ(cross.centre, Vec3::Zero());
  // of two in common, across both: squares of side 2 s, s^2 = r^2 - z^2; moments of x^2 and z^2
  const double x2 = 64.0 / 45 * std::pow(r, 5), z2 = 16.0 / 15 * std::pow(r, 5);
  const auto lone = mass_properties(Cylinder{r, l}).inertia;
  const double about_z = 2 * lone(0, 0) - 2 * x2, about_x = lone(0, 0) + lone(2, 2) - (x2 + z2);
  EXPECT_NEAR(cross.inertia(2, 2) / about_z - 1, 0, promised / 5);
  EXPECT_NEAR(cross.inertia(0, 0) / about_x - 1, 0, promised / 5);
}

TEST(MassProperties, OverlapsOfTheOtherShapes) {
  const double r = 0.4;  // a pin through a plate
  const auto pin = mass_properties(Compound{{{Box{{1, 0.8, 0.2}}, {}}, {Cylinder{r, 1.5}, {}}}});
  EXPECT_NEAR(pin.volume / (8 * 0.16 + 2 * pi * r * r * (1.5 - 0.2)) - 1, 0, promised / 5);
  // two spheres with their lens, drawn out to ellipsoids
  const Vec3 axes(1.5, 0.7, 1);
  const double d = 0.8, lens = pi * (4 + d) * (2 - d) * (2 - d) / 12;
  const auto pair = mass_properties(Compound{{{Ellipsoid{axes}, {{0, 0, d / 2}, Quat::Identity()}},
                                              {Ellipsoid{axes}, {{0, 0, -d / 2}, Quat::Identity()}}}});
  EXPECT_NEAR(pair.volume / (axes.prod() * (8 * pi / 3 - lens)) - 1, 0, promised / 5);
  // two tetrahedra of a cube (the stella octangula): they share the octahedron, a sixth of the cube
  const auto stella = mass_properties(
      Compound{{{testing::tetrahedron({1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}), {}},
                {testing::tetrahedron({-1, -1, -1}, {1, -1, 1}, {1, 1, -1}, {-1, 1, 1}), {}}}});
  EXPECT_NEAR(stella.volume / (2 * 8.0 / 3 - 8.0 / 6) - 1, 0, promised / 5);
  EXPECT_EQ(stella.inertia(0, 0), stella.inertia(1, 1));
  EXPECT_EQ(stella.centre, Vec3::Zero());
}

TEST(MassProperties, StarOfCapsulesTurnsWithItsAxes) {
  const auto star = [](const Quat& turn) {
    Compound c;
    for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
      c.parts.push_back({Capsule{0.3, 1.1}, {Vec3::Zero(), turn * z_to(axis)}});
    return c;
  };
  const auto before = std::chrono::steady_clock::now();
  const auto p = mass_properties(star(Quat::Identity()));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
  const auto q = mass_properties(star(Quat(0.3, 0.5, -0.2, 0.7).normalized()));
  EXPECT_NEAR(p.volume / q.volume - 1, 0, promised / 5);
  EXPECT_NEAR(p.inertia.trace() / q.inertia.trace() - 1, 0, promised / 5);
  EXPECT_LT(seconds, 2.0);  // generous: the machine may be shared
  // three crossed cylinders of radius r have in common with each other Steinmetz' solids (16/3 r^3, 8 (2 -
  // sqrt 2) r^3)
  const double r = 0.3, one = mass_properties(Capsule{0.3, 1.1}).volume;
  const double exact = 3 * one - 3 * 16.0 / 3 * r * r * r + 8 * (2 - std::sqrt(2.0)) * r * r * r;
  EXPECT_NEAR(p.volume / exact - 1, 0, promised / 5);
  RecordProperty("milliseconds", static_cast<int>(1000 * seconds));
}

TEST(Polyhedron, FacesEdgesAndNeighboursOfACuboid) {
  const auto mesh = testing::cuboid({1, 2, 3}, {2, 4, 7}).mesh;
  ASSERT_EQ(mesh->faces.size(), 6u);
  ASSERT_EQ(mesh->edges.size(), 12u);
  std::set<std::array<int, 2>> seen;
  for (const auto& edge : mesh->edges) {
    EXPECT_TRUE(
        seen.insert({std::min(edge.corners[0], edge.corners[1]), std::max(edge.corners[0], edge.corners[1])})
            .second);
    const Vec3 along = mesh->vertices[edge.corners[1]] - mesh->vertices[edge.corners[0]];
    for (const int f : edge.faces) EXPECT_EQ(mesh->faces[f].normal.dot(along), 0);
    // counter-clockwise in the first, clockwise in the second face
    const Vec3 outward = along.cross(mesh->faces[edge.faces[0]].normal);
    EXPECT_GT(outward.dot(mesh->faces[edge.faces[1]].normal), 0.5);
  }
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(mesh->neighbours[i].size(), 3u);
  for (const auto& face : mesh->faces) {
    EXPECT_DOUBLE_EQ(face.normal.norm(), 1);
    EXPECT_LT(face.normal.dot(Vec3(1.5, 3, 5)), face.offset);
    for (const int c : face.corners) EXPECT_DOUBLE_EQ(face.normal.dot(mesh->vertices[c]), face.offset);
  }
  const auto moved = shifted(*mesh, {1, 1, 1});
  for (const auto& face : moved->faces)
    for (const int c : face.corners) EXPECT_DOUBLE_EQ(face.normal.dot(moved->vertices[c]), face.offset);
}

std::string refusal(std::vector<Vec3> corners, std::vector<std::vector<int>> faces) {
  return tests::error_of<std::invalid_argument>([&] { make_polyhedron_mesh(std::move(corners), faces); });
}

TEST(Polyhedron, RefusesWhatIsNone) {
  const auto corners = testing::hexahedron_corners({0, 0, 0}, {1, 1, 1});
  const auto faces = testing::hexahedron_faces();
  EXPECT_EQ(refusal(corners, faces), "");
  EXPECT_EQ(refusal({{0, 0, 0}, {1, 0, 0}}, {}), "polyhedron: it needs at least 4 corners and 4 faces");

  auto open = faces;
  open.pop_back();
  EXPECT_EQ(refusal(corners, open),
            "polyhedron: it is not closed: only one face has the edge from corner 4 to 6");
  auto inside_out = faces;
  for (auto& loop : inside_out) std::reverse(loop.begin(), loop.end());
  EXPECT_EQ(refusal(corners, inside_out),
            "polyhedron: its faces are clockwise seen from outside, or it has no volume");
  auto one_turned = faces;
  std::reverse(one_turned[0].begin(), one_turned[0].end());
  EXPECT_EQ(refusal(corners, one_turned),
            "polyhedron: two faces run the same way along the edge from corner 4");
  auto bent = corners;
  bent[7] = {1.1, 1, 1};
  EXPECT_EQ(refusal(bent, faces), "polyhedron: face 1 is not flat at corner 1");
  auto spare = corners;
  spare.push_back({0.5, 0.5, 0.5});
  EXPECT_EQ(refusal(spare, faces), "polyhedron: corner 8 belongs to no face");
  auto wild = faces;
  wild[2][1] = 9;
  EXPECT_EQ(refusal(corners, wild), "polyhedron: face 2 names corner 9, which is not there");
  // a pyramid whose tip is pushed in beyond its base: closed, each face flat, but not convex
  EXPECT_EQ(refusal({{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}, {0.3, 0.3, 0.3}},
                    {{0, 2, 1}, {0, 1, 3}, {2, 0, 3}, {1, 2, 4}, {2, 3, 4}, {3, 1, 4}}),
            "polyhedron: it is not convex: corner 3 lies outside face 3");
}

TEST(Polyhedron, NearestCornerNeedNotBelongToTheFurthestPlane) {
  // a steep pyramid, one edge of its side cut off below by a plane that is less steep than the sides: high
  // above the tip this plane is the furthest, but its face does not reach the tip
  const Vec3 tip(0, 0, 10), a(2, 0, 0), b(-1, 1.7, 0), c(-1, -1.7, 0);
  const double cut = 0.2 / 3;
  const Polyhedron obelisk{
      make_polyhedron_mesh({tip, 0.5 * (tip + a), a + cut * (b - a), a + cut * (c - a), b, c},
                           {{0, 1, 2, 4}, {0, 4, 5}, {0, 5, 3, 1}, {1, 3, 2}, {2, 3, 5, 4}})};
  const Vec3 x(0, 0, 20);
  double furthest = 0;
  int face = -1;
  for (int f = 0; f < 5; ++f) {
    const auto& plane = obelisk.mesh->faces[f];
    if (const double height = plane.normal.dot(x) - plane.offset; height > furthest)
      furthest = height, face = f;
  }
  ASSERT_EQ(face, 3);
  EXPECT_DOUBLE_EQ(signed_distance(obelisk, x), 10);
}

TEST(Polyhedron, TurnsLikeItsPrincipalAxesSay) {
  // the corner of a cube has off-diagonal inertia; about its principal axes the same motion is Euler's
  const auto p = mass_properties(testing::tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1.4, 0}, {0, 0, 1.9}));
  ASSERT_GT(std::abs(p.inertia(0, 1)), 0.05 * p.inertia(0, 0));
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(p.inertia);
  Mat3 axes = eigen.eigenvectors();
  if (axes.determinant() < 0) axes.col(0) *= -1;
  const Mat3 diagonal = eigen.eigenvalues().asDiagonal();
  const Vec3 momentum(0.01, -0.02, 0.03);
  Quat full = Quat::Identity(), principal = Quat(axes);
  for (int step = 0; step < 500; ++step) {
    full = free_rotation(full, p.inertia, momentum, 0.05);
    principal = free_rotation(principal, diagonal, momentum, 0.05);
  }
  EXPECT_LT((full.toRotationMatrix() * axes - principal.toRotationMatrix()).norm(), 1e-11);
  EXPECT_GT((full.toRotationMatrix() - Mat3::Identity()).norm(), 0.1) << "it has turned";
}

}  // namespace
}  // namespace silt::rigid

// Surfaces of bodies as triangles, slender bodies among them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "silt/case/case.hpp"
#include "silt/results/body_output.hpp"
#include "silt/simulation.hpp"
#include "tests/rigid/shapes/solids.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::testing {
namespace {

using rigid::ConvexShape;
using rigid::Part;
using rigid::Pose;
using rigid::Quat;
using rigid::Vec3;

struct Solid {
  ConvexShape shape;
  bool curved;
};

/// Round, long and flat ones, and polytopes.
std::vector<Solid> solids() {
  return {{rigid::Sphere{1.3}, true},
          {rigid::Capsule{0.6, 0.9}, true},
          {rigid::Capsule{0.1, 2.0}, true},
          {rigid::Cylinder{0.6, 0.9}, true},
          {rigid::Cylinder{1.5, 0.05}, true},
          {rigid::Cylinder{0.05, 1.7}, true},
          {rigid::Ellipsoid{{1.4, 0.5, 0.9}}, true},
          {rigid::Ellipsoid{{1.5, 1.5, 0.15}}, true},
          {rigid::Ellipsoid{{0.3, 0.3, 2.0}}, true},
          {rigid::Box{{0.5, 1.1, 0.8}}, false},
          {rigid::Box{{5.0, 1.0, 0.02}}, false},
          {rigid::testing::frustum(), false},
          {rigid::testing::octahedron({1.2, 0.8, 1.7}), false},
          {rigid::testing::tetrahedron({0.5, 0.2, 0.1}, {1.8, 0.3, 0}, {0.7, 1.9, 0.4}, {1, 1, 1.6}), false}};
}

/// Needles and discs, as long as thick up to 1000 times.
std::vector<ConvexShape> slender_solids() {
  std::vector<ConvexShape> all;
  for (const double thin : {1 / 24., 1e-2, 1 / 200., 1e-3})
    for (const double side : {thin, 1.}) {
      const double along = side == 1 ? thin : 1;  // a needle or a disc
      all.insert(all.end(),
                 {rigid::Ellipsoid{{side, side, along}}, rigid::Ellipsoid{{side, std::sqrt(thin), along}},
                  rigid::Cylinder{side, along}, rigid::Box{{side, side, along}},
                  rigid::testing::octahedron({side, side, along})});
      if (along == 1) all.push_back(rigid::Capsule{side, along});
    }
  return all;
}

rigid::Shape whole(const ConvexShape& convex) {
  return std::visit([](const auto& s) -> rigid::Shape { return s; }, convex);
}

std::string name_of(const ConvexShape& convex) {
  return std::string(rigid::shape_name(whole(convex)));
}

adapters::TriangleMesh mesh_of(const ConvexShape& shape) {
  return tessellation({shape, Pose{}}, 1);
}

Vec3 vec(const std::array<double, 3>& a) {
  return {a[0], a[1], a[2]};
}

/// Twice the area, along the outward normal.
Vec3 area_of(const adapters::TriangleMesh& mesh, const std::array<std::int32_t, 3>& t) {
  const Vec3 a = vec(mesh.vertices[t[0]]);
  return (vec(mesh.vertices[t[1]]) - a).cross(vec(mesh.vertices[t[2]]) - a);
}

double volume_of(const adapters::TriangleMesh& mesh) {
  double volume = 0;
  for (const auto& t : mesh.triangles) volume += vec(mesh.vertices[t[0]]).dot(area_of(mesh, t)) / 6;
  return volume;
}

double area_of(const adapters::TriangleMesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles) area += area_of(mesh, t).norm() / 2;
  return area;
}

TEST(Tessellation, is_closed_and_has_the_volume_of_the_shape) {
  std::vector<Solid> all = solids();
  for (const ConvexShape& slender : slender_solids()) all.push_back({slender, true});
  for (const auto& [shape, curved] : all) {
    const rigid::BoundingBox box = rigid::bounding_box(whole(shape), Pose{});
    SCOPED_TRACE(name_of(shape) + " from " +
                 ::testing::PrintToString(std::vector(box.lower.begin(), box.lower.end())));
    const auto mesh = mesh_of(shape);
    std::map<std::pair<int, int>, int> uses;
    for (const auto& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) ++uses[{t[k], t[(k + 1) % 3]}];
    std::size_t open = 0;
    for (const auto& [edge, count] : uses) open += count != 1 || uses.count({edge.second, edge.first}) != 1;
    EXPECT_EQ(open, 0u) << "every edge has a triangle on each side";
    EXPECT_EQ(mesh.vertices.size() + mesh.triangles.size(), uses.size() / 2 + 2);  // Euler: one piece
    EXPECT_EQ(mesh.triangles.size(), mesh.triangle_normals.size());
    const double relative = volume_of(mesh) / rigid::mass_properties(whole(shape)).volume - 1;
    EXPECT_GT(relative, curved ? -0.012 : -1e-12);
    EXPECT_LT(relative, 1e-9);  // inscribed
  }
}

TEST(Tessellation, has_the_area_of_the_shape) {
  constexpr double pi = std::numbers::pi;
  const auto relative = [](const ConvexShape& shape, double exact) {
    return area_of(mesh_of(shape)) / exact - 1;
  };
  EXPECT_NEAR(relative(rigid::Sphere{1.3}, 4 * pi * 1.3 * 1.3), 0, 0.01);
  EXPECT_NEAR(relative(rigid::Capsule{0.6, 0.9}, 4 * pi * 0.36 + 2 * pi * 0.6 * 1.8), 0, 0.01);
  EXPECT_NEAR(relative(rigid::Cylinder{0.6, 0.9}, 2 * pi * 0.36 + 2 * pi * 0.6 * 1.8), 0, 0.01);
  EXPECT_NEAR(relative(rigid::Box{{0.5, 1.1, 0.8}}, 8 * (0.55 + 0.88 + 0.4)), 0, 1e-12);
}

TEST(Tessellation, vertices_lie_on_the_surface_and_triangles_close_to_it) {
  for (const Solid& solid : solids()) {
    SCOPED_TRACE(name_of(solid.shape));
    const rigid::Shape shape = whole(solid.shape);
    const auto mesh = mesh_of(solid.shape);
    for (const auto& v : mesh.vertices) EXPECT_NEAR(rigid::signed_distance(shape, vec(v)), 0, 1e-9);
    for (const auto& t : mesh.triangles) {
      const Vec3 middle =
          (vec(mesh.vertices[t[0]]) + vec(mesh.vertices[t[1]]) + vec(mesh.vertices[t[2]])) / 3;
      const double depth = -rigid::signed_distance(shape, middle);
      EXPECT_LT(depth, tessellation_tolerance * rigid::bounding_radius(shape));
    }
  }
}

TEST(Tessellation, normals_are_those_of_the_surface_on_the_side_of_the_triangle) {
  for (const Solid& solid : solids()) {
    SCOPED_TRACE(name_of(solid.shape));
    const auto mesh = mesh_of(solid.shape);
    const double size = rigid::bounding_radius(whole(solid.shape));
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const Vec3 outward = area_of(mesh, mesh.triangles[i]).normalized();
      for (int k = 0; k < 3; ++k) {
        const Vec3 v = vec(mesh.vertices[mesh.triangles[i][k]]);
        const Vec3 n = vec(mesh.normals[mesh.triangle_normals[i][k]]);
        EXPECT_NEAR(n.norm(), 1, 1e-12);
        EXPECT_LT(n.dot(rigid::support(solid.shape, n) - v), 1e-5 * size);
        EXPECT_GT(n.dot(outward), solid.curved ? 0.5 : 1 - 1e-12);  // 0.75 at the rim of the flat ellipsoid
      }
    }
  }
}

TEST(Tessellation, keeps_corners_edges_and_flat_faces) {
  const auto box = mesh_of(rigid::Box{{0.5, 1.1, 0.8}});
  EXPECT_EQ(box.vertices.size(), 8u);
  EXPECT_EQ(box.triangles.size(), 12u);
  const auto cylinder = mesh_of(rigid::Cylinder{0.6, 0.9});
  for (const auto& v : cylinder.vertices) {  // on the two rims, and nowhere else
    EXPECT_NEAR(std::abs(v[2]), 0.9, 1e-12);
    EXPECT_NEAR(std::hypot(v[0], v[1]), 0.6, 1e-12);
  }
  for (const auto& n : cylinder.normals)  // an end's or the flank's, nothing between
    EXPECT_LT(std::min(std::abs(n[2]), 1 - std::abs(n[2])), 1e-2);
}

TEST(Tessellation, stands_in_the_frame_of_the_body_in_the_unit_asked_for) {
  const Pose pose{{0.3, -1, 2}, Quat(0.5, 0.1, -0.7, 0.5).normalized()};
  const ConvexShape shape = rigid::Box{{0.5, 1.1, 0.8}};
  const auto placed = tessellation({shape, pose}, 0.25), plain = mesh_of(shape);
  ASSERT_EQ(placed.vertices.size(), plain.vertices.size());
  ASSERT_EQ(placed.normals.size(), plain.normals.size());
  for (std::size_t i = 0; i < plain.vertices.size(); ++i)
    EXPECT_NEAR((vec(placed.vertices[i]) - 0.25 * pose.to_world(vec(plain.vertices[i]))).norm(), 0, 1e-14);
  for (std::size_t i = 0; i < plain.normals.size(); ++i)
    EXPECT_NEAR((vec(placed.normals[i]) - pose.orientation * vec(plain.normals[i])).norm(), 0, 1e-14);
}

TEST(Tessellation, refuses_what_has_no_end) {
  EXPECT_THROW(mesh_of(rigid::HalfSpace{Vec3::UnitZ()}), std::invalid_argument);
}

constexpr double length = 200;

struct Slender {
  std::string type, sizes;
  double volume;
};

/// The corners of a prism of n sides about z.
std::string prism(double radius, double height, int n) {
  std::string list;
  for (int i = 0; i < 2 * n; ++i) {
    const double angle = 2 * std::numbers::pi * (i % n) / n;
    list += fmt::format("{}[{:.17g}, {:.17g}, {}]", i ? ", " : "", radius * std::cos(angle),
                        radius * std::sin(angle), i < n ? 0 : height);
  }
  return "vertices = [" + list + "]";
}

/// Returns solids of width `across` and height `along`.
std::vector<Slender> solids(double across, double along) {
  constexpr double pi = std::numbers::pi;
  const auto rod = [&](const char* height) {
    return fmt::format("diameter = {}\n{} = {}", across, height, along);
  };
  const double middle = std::sqrt(across * along), disc = pi / 4 * across * across;
  std::vector<Slender> all = {
      {"ellipsoid", fmt::format("diameters = [{0}, {0}, {1}]", across, along), 2. / 3 * disc * along},
      {"ellipsoid", fmt::format("diameters = [{}, {}, {}]", across, middle, along),
       pi / 6 * across * middle * along},
      {"cylinder", rod("length"), disc * along},
      {"box", fmt::format("edges = [{0}, {0}, {1}]", across, along), across * across * along},
      {"polyhedron", prism(across / 2, along, 12), 6 * std::sin(pi / 6) * across * across / 4 * along},
      {"polyhedron", prism(across / 2, along, 200), 100 * std::sin(pi / 100) * across * across / 4 * along},
      {"polyhedron",
       fmt::format("vertices = [[0, 0, 0], [{0}, 0, 0], [0, {0}, 0], [0, 0, {1}]]", across, along),
       across * across * along / 6}};
  if (along > across) all.push_back({"capsule", rod("length"), disc * along + 2. / 3 * disc * across});
  return all;
}

TEST(SlenderBodies, AreSoundRunAndAreDrawn) {
  CaseText c;
  c.domain = domain_of({480, 480, 480});
  c.fluid = "";
  for (const double thick : {length / 24, length / 100, length / 1000})
    for (const bool needle : {true, false})
      for (const Slender& solid : needle ? solids(thick, length) : solids(length, thick)) {
        SCOPED_TRACE(solid.type + ", " + solid.sizes.substr(0, 60));
        c.shapes = shape_of("body", solid.type, solid.sizes);
        c.bodies = body_of("body", 2, "position = [240, 240, 240]\nangular_velocity = [1e-5, 0, 0]");
        const Case scene = c.read();
        EXPECT_FALSE(has_errors(judgement(scene)));
        Simulation simulation(scene, MPI_COMM_SELF);
        simulation.run(1);
        EXPECT_NEAR(simulation.bodies().mass[0], 2 * solid.volume, 1e-9 * solid.volume);
        const auto kinds = drawn_kinds(scene);
        ASSERT_EQ(kinds.size(), 1u);
        EXPECT_GE(kinds[0].parts.at(0).triangles.size(), 4u);
      }
}

/// A polyhedron of corners on an ellipsoid, turned: every corner of it is one of its hull's.
TEST(SlenderBodies, KeepAllCornersOfTheirHulls) {
  const rigid::Quat turn = rigid::Quat(0.3, 0.5, -0.2, 0.7).normalized();
  for (const double thin : {1 / 24., 1e-2, 1e-3}) {
    std::string list;
    for (int i = 0; i < 200; ++i) {
      const double z = 1 - (2 * i + 1.) / 200, angle = i * std::numbers::pi * (3 - std::sqrt(5.)),
                   r = std::sqrt(1 - z * z);
      const rigid::Vec3 x =
          length / 2 *
          (turn * rigid::Vec3(thin * r * std::cos(angle), std::sqrt(thin) * r * std::sin(angle), z));
      list += fmt::format("{}[{:.17g}, {:.17g}, {:.17g}]", i ? ", " : "", x[0], x[1], x[2]);
    }
    CaseText c;
    c.domain = domain_of({480, 480, 480});
    c.fluid = "";
    c.shapes = shape_of("body", "polyhedron", "vertices = [" + list + "]");
    c.bodies = body_of("body", 2, "position = [240, 240, 240]");
    Simulation simulation(c.read(), MPI_COMM_SELF);
    const double ellipsoid = std::numbers::pi / 6 * std::pow(length, 3) * std::pow(thin, 1.5);
    EXPECT_NEAR(simulation.bodies().mass[0] / 2, 0.9704211141 * ellipsoid, 1e-9 * ellipsoid)
        << "as of the 200 points on a sphere";
  }
}

}  // namespace
}  // namespace silt::testing

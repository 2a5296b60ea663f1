#pragma once
// One row a convex shape: what the suites of shapes, of mapping and of collision backends need to know of it.
#include <numeric>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "rigid/shapes/shape.hpp"
#include "tests/hull_of.hpp"
#include "tests/rigid/shapes/solids.hpp"

namespace silt::tests {

using rigid::ConvexShape;
using rigid::Vec3;

/// Made up anew for each scene: sizes of 3 to 20 lattice units.
class Sizes {
 public:
  explicit Sizes(std::mt19937_64& random) : random_(random) {}
  double operator()() const { return std::uniform_real_distribution<double>(3, 20)(random_); }
  Vec3 three() const { return Vec3((*this)(), (*this)(), (*this)()); }
  std::mt19937_64& random() const { return random_; }

 private:
  std::mt19937_64& random_;
};

inline Vec3 random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Vec3(normal(random), normal(random), normal(random)).normalized();
}

/// Returns the hull of twelve points, some with faces of four corners: symmetric about the origin in z.
inline ConvexShape random_polyhedron(const Sizes& size) {
  const Vec3 half(size(), size(), size());
  std::vector<Vec3> points;
  for (int i = 0; i < 12; ++i) points.push_back(half.cwiseProduct(random_direction(size.random())));
  if (size.random()() % 2)
    for (int i = 0; i < 6; ++i) points[i + 6] = points[i].cwiseProduct(Vec3(1, 1, -1));
  const Vec3 middle = std::accumulate(points.begin(), points.end(), Vec3(Vec3::Zero())) / 12;
  for (Vec3& x : points) x -= middle;
  return hull_of(points);
}

struct ShapeRow {
  std::string_view name;
  std::vector<ConvexShape>
      solids;              // some 1 across: plain, long and flat ones, sharp and blunt, off the origin
  ConvexShape cells_wide;  // some cells across
  std::string sizes;       // the keys in a case of one some cells across
  ConvexShape (*random)(const Sizes&);
  /// Circles of directions in which the supporting point jumps, and normals of flat faces; body frame. They
  /// tell the search of the reference where its optimum may hide.
  void (*kinks)(const ConvexShape&, rigid::Kinks&);
};

inline void no_kinks(const ConvexShape&, rigid::Kinks&) {}
inline void kinks_about_axis(const ConvexShape&, rigid::Kinks& k) {
  k.circles.push_back(Vec3::UnitZ());
}
inline void kinks_of_cylinder(const ConvexShape&, rigid::Kinks& k) {
  k.circles.push_back(Vec3::UnitZ());
  k.faces.push_back(Vec3::UnitZ());
}
inline void kinks_of_box(const ConvexShape&, rigid::Kinks& k) {
  for (int d = 0; d < 3; ++d) k.circles.push_back(Vec3::Unit(d)), k.faces.push_back(Vec3::Unit(d));
}
inline void kinks_of_polyhedron(const ConvexShape& shape, rigid::Kinks& k) {
  const auto& mesh = *std::get<rigid::Polyhedron>(shape).mesh;
  for (const auto& e : mesh.edges)
    k.circles.push_back((mesh.vertices[e.corners[1]] - mesh.vertices[e.corners[0]]).normalized());
  for (const auto& f : mesh.faces) k.faces.push_back(f.normal);
}

/// A shape of one to three random sizes.
template <class Shape>
ConvexShape random_shape(const Sizes& size) {
  if constexpr (requires { Shape{size.three()}; })
    return Shape{size.three()};
  else if constexpr (requires { Shape{size(), size()}; })
    return Shape{size(), size()};
  else
    return Shape{size()};
}

inline std::vector<ShapeRow> shape_rows() {
  using namespace rigid;
  namespace t = rigid::testing;
  return {
      {"sphere", {Sphere{1.3}}, Sphere{3.1}, "diameter = 6.1", random_shape<Sphere>, no_kinks},
      {"box",
       {Box{{0.5, 1.1, 0.8}}},
       Box{{4.2, 3.3, 1.7}},
       "edges = [8.3, 6.1, 4.7]",
       random_shape<Box>,
       kinks_of_box},
      {"capsule",
       {Capsule{0.6, 0.9}},
       Capsule{1.9, 3.3},
       "radius = 2.6\nlength = 5.3",
       random_shape<Capsule>,
       kinks_about_axis},
      {"cylinder",
       {Cylinder{0.6, 0.9}, Cylinder{1.5, 0.05}, Cylinder{0.05, 1.7}},
       Cylinder{3.2, 2.9},
       "radius = 3.7\nlength = 6.2",
       random_shape<Cylinder>,
       kinks_of_cylinder},
      {"ellipsoid",
       {Ellipsoid{{1.4, 0.5, 0.9}}, Ellipsoid{{1.5, 1.5, 0.015}}, Ellipsoid{{0.02, 0.02, 2}},
        Ellipsoid{{1, 1, 1 + 1e-9}}},
       Ellipsoid{{4, 3, 1}},
       "diameters = [9.1, 6.3, 4.9]",
       random_shape<Ellipsoid>,
       no_kinks},
      {"polyhedron",
       {t::cuboid({-0.5, -0.7, -1.1}, {0.5, 0.7, 1.1}), t::frustum(), t::octahedron({1.2, 0.8, 1.7}),
        t::tetrahedron({0.5, 0.2, 0.1}, {1.8, 0.3, 0}, {0.7, 1.9, 0.4}, {1, 1, 1.6})},
       t::octahedron({3, 4, 5}),
       "vertices = [[4, 0, -2], [-1, 4.5, -2], [-4, -1, -2.5], [0, -4, -2], [0.5, 0.3, 5]]",
       random_polyhedron,
       kinks_of_polyhedron},
  };
}

inline const ShapeRow& row_of(std::string_view name) {
  static const std::vector<ShapeRow> rows = shape_rows();
  for (const ShapeRow& row : rows)
    if (row.name == name) return row;
  throw std::invalid_argument("tests/shape_rows.hpp has no row for the shape " + std::string(name));
}

/// The solids of all rows.
inline std::vector<ConvexShape> all_solids() {
  std::vector<ConvexShape> all;
  for (const ShapeRow& row : shape_rows()) all.insert(all.end(), row.solids.begin(), row.solids.end());
  return all;
}

}  // namespace silt::tests

#pragma once
// The geometry of a closed triangle mesh, computed once from vertices and triangles and then shared.
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "rigid/shapes/box_tree.hpp"
#include "rigid/shapes/mass_properties.hpp"
#include "rigid/shapes/solid.hpp"

namespace silt::rigid {

/// A closed surface: each edge has two triangles of opposite orientation (adapters/mesh checks). Several
/// shells and cavities are possible. Vertices are kept in lexicographic order and triangles in an order that
/// follows from it, so results do not depend on the order of the input.
class TriangleMesh {
 public:
  using Triangle = std::array<std::uint32_t, 3>;  // vertex numbers, counter-clockwise seen from outside

  /// Throws std::invalid_argument for no triangles, too many triangles, or missing vertices.
  TriangleMesh(std::vector<Vec3> vertices, std::vector<Triangle> triangles);

  std::span<const Vec3> vertices() const { return vertices_; }
  std::span<const Triangle> triangles() const { return triangles_; }
  std::array<Vec3, 3> corners(std::uint32_t triangle) const {
    const Triangle& t = triangles_[triangle];
    return {vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]};
  }
  /// Returns the outward normal times twice the area.
  Vec3 area_normal(std::uint32_t triangle) const;
  const BoundingBox& box() const { return box_; }
  /// Returns the distance of the vertex furthest from the origin.
  double radius() const { return radius_; }
  /// Returns the tree whose items are the triangles.
  const BoxTree& tree() const { return tree_; }

  struct Nearest {
    double distance = std::numeric_limits<double>::infinity();  // >= 0; infinite if none is within reach
    std::uint32_t triangle = 0;
    Vec3 point = Vec3::Zero();  // of the surface
  };
  /// Returns the surface point nearest to x within the given distance; of equal ones the first.
  Nearest nearest(const Vec3& x, double within = std::numeric_limits<double>::infinity()) const;

  struct Hit {
    double t;  // o + t d is the hit point
    std::uint32_t triangle;
  };
  /// Returns the first hit of the ray o + t d, 0 <= t <= t_max, d of any nonzero length. Watertight: no ray
  /// passes between adjacent triangles (S. Woop, C. Benthin, I. Wald, J. Comput. Graph. Techn. 2 (2013) 65).
  std::optional<Hit> first_hit(const Vec3& o, const Vec3& d, double t_max) const;

  /// Returns whether x is inside: whether a ray along x crosses an odd number of triangles. Exact for
  /// vertices and x rounded to 2^-38 of the mesh's size: in integers, with x shifted infinitesimally so that
  /// edges and vertices are crossed once. On the surface either answer is possible.
  bool encloses(const Vec3& x) const {
    return encloses(x, [](std::uint32_t) { return true; });
  }
  /// The same with only the triangles for which counts(triangle) is true.
  bool encloses(const Vec3& x, const std::function<bool(std::uint32_t)>& counts) const;

  /// Calls visit(triangle) for all triangles whose boxes overlap `near`, and perhaps some more.
  template <class Visit>
  void for_near(const BoundingBox& near, Visit&& visit) const {
    constexpr double limit = 0.5;
    tree_.search([&](const BoxTree::Node& node) { return node.overlaps(near) ? 0.0 : 1.0; }, limit, visit);
  }

  /// For unit density: exact integrals over the polyhedron, summed in extended precision about the middle of
  /// its box (F. Tonon, J. Math. Stat. 1 (2004) 8).
  MassProperties mass_properties() const;
  TriangleMesh shifted(const Vec3& by) const;
  TriangleMesh scaled(double factor) const;

 private:
  void sort_vertices();
  void sort_triangles();
  void build_tree();

  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;
  BoundingBox box_ = BoundingBox::empty();
  double radius_ = 0;
  BoxTree tree_;
};

/// Side k of a triangle: from its corner k to the next.
struct TriangleSide {
  std::uint32_t low, high;  // vertex numbers
  std::uint32_t triangle, k;
  auto operator<=>(const TriangleSide&) const = default;
  bool same_edge(const TriangleSide& o) const { return low == o.low && high == o.high; }
};
/// Returns all sides of the triangles, sorted by edge.
std::vector<TriangleSide> sides_of(std::span<const TriangleMesh::Triangle>);

using SharedMesh = std::shared_ptr<const TriangleMesh>;

/// The solid inside a closed triangle mesh, or, if hollow, everything outside it: a vessel. A mesh is not
/// convex; a hollow one has infinite mass and is for walls only.
struct Mesh {
  static constexpr std::string_view name = "mesh";
  SharedMesh surface;  // never null
  bool hollow = false;

  /// For a point on the surface, to rounding, either answer is possible.
  bool contains(const Vec3& x) const { return surface->encloses(x) != hollow; }
  double signed_distance(const Vec3& x) const {
    const double distance = surface->nearest(x).distance;
    return contains(x) ? -distance : distance;
  }
  /// Returns the box around the rotated box of the body frame, not the tightest.
  BoundingBox bounding_box(const Pose& pose) const {
    if (hollow) return BoundingBox::everything();
    const Vec3 half = 0.5 * (surface->box().upper - surface->box().lower);
    const Vec3 middle = 0.5 * (surface->box().upper + surface->box().lower);
    const Mat3 turn = pose.orientation.toRotationMatrix();
    return BoundingBox::around(pose.position + turn * middle, turn.cwiseAbs() * half);
  }
  double bounding_radius() const { return hollow ? boundless : surface->radius(); }
  MassProperties mass_properties() const {
    if (hollow) throw std::invalid_argument("a hollow mesh has no mass");
    return surface->mass_properties();
  }
  /// Returns the least side of its box in the body frame; infinite if hollow.
  double least_width() const {
    return hollow ? boundless : (surface->box().upper - surface->box().lower).minCoeff();
  }
  Mesh recentred(const Vec3& centre) const {
    return {std::make_shared<const TriangleMesh>(surface->shifted(-centre)), hollow};
  }

 private:
  static constexpr double boundless = std::numeric_limits<double>::infinity();
};

}  // namespace silt::rigid

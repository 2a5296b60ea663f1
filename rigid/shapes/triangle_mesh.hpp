#pragma once
// The geometry of a closed surface of triangles: made once from its corners and triangles, then shared by all
// who look at it.
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

/// Closed: each edge belongs to two triangles that run along it in opposite ways (adapters/mesh sees to it);
/// several shells are possible, and hollows. Corners are kept in lexicographic order and triangles in an
/// order that follows from them, so that nothing depends on the order in which they were given.
class TriangleMesh {
 public:
  using Triangle = std::array<std::uint32_t, 3>;  // of vertices, counter-clockwise seen from outside

  /// std::invalid_argument if there are no triangles, too many, or corners that do not exist.
  TriangleMesh(std::vector<Vec3> vertices, std::vector<Triangle> triangles);

  std::span<const Vec3> vertices() const { return vertices_; }
  std::span<const Triangle> triangles() const { return triangles_; }
  std::array<Vec3, 3> corners(std::uint32_t triangle) const {
    const Triangle& t = triangles_[triangle];
    return {vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]};
  }
  /// Outward, of length twice the area.
  Vec3 area_normal(std::uint32_t triangle) const;
  const BoundingBox& box() const { return box_; }
  /// Returns the distance of the corner furthest from the origin.
  double radius() const { return radius_; }
  /// Its items are the triangles.
  const BoxTree& tree() const { return tree_; }

  struct Nearest {
    double distance = std::numeric_limits<double>::infinity();  // >= 0; infinite: nothing within reach
    std::uint32_t triangle = 0;
    Vec3 point = Vec3::Zero();  // of the surface
  };
  /// The point of the surface nearest to x, if it is within a distance; of several triangles that have it the
  /// first.
  Nearest nearest(const Vec3& x, double within = std::numeric_limits<double>::infinity()) const;

  struct Hit {
    double t;  // o + t d is on the surface
    std::uint32_t triangle;
  };
  /// The first hit of the ray o + t d with 0 <= t <= t_max. It slips through no edge (S. Woop, C. Benthin,
  /// I. Wald, J. Comput. Graph. Techn. 2 (2013) 65). d need not be a unit vector.
  std::optional<Hit> first_hit(const Vec3& o, const Vec3& d, double t_max) const;

  /// Says whether x is within the surface: a line from it along x crosses an odd number of triangles. The
  /// answer is exact, with the corners and x rounded to 2^-38 of the mesh's size: in whole numbers, as if x
  /// were a little further along x, less along y, still less along z, so that no edge or corner is met twice
  /// or not at all. A point on the surface is on either side.
  bool encloses(const Vec3& x) const {
    return encloses(x, [](std::uint32_t) { return true; });
  }
  /// Says whether x is within the surface by those triangles alone for which counts(triangle) is true.
  bool encloses(const Vec3& x, const std::function<bool(std::uint32_t)>& counts) const;

  /// Calls visit(triangle) for those whose box overlaps another, and perhaps some near it.
  template <class Visit>
  void for_near(const BoundingBox& near, Visit&& visit) const {
    constexpr double limit = 0.5;
    tree_.search([&](const BoxTree::Node& node) { return node.overlaps(near) ? 0.0 : 1.0; }, limit, visit);
  }

  /// Returns those of unit density: exact integrals over the polyhedron, summed in extended precision about
  /// the middle of its box (F. Tonon, J. Math. Stat. 1 (2004) 8).
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
  std::uint32_t low, high;  // corners
  std::uint32_t triangle, k;
  auto operator<=>(const TriangleSide&) const = default;
  bool same_edge(const TriangleSide& o) const { return low == o.low && high == o.high; }
};
/// All sides of triangles, those of one edge one after the other.
std::vector<TriangleSide> sides_of(std::span<const TriangleMesh::Triangle>);

using SharedMesh = std::shared_ptr<const TriangleMesh>;

/// A mesh is the solid that a closed surface of triangles encloses, or, if hollow, all that it does not: a
/// vessel. It is not convex; a hollow one is for walls only and has infinite mass.
struct Mesh {
  static constexpr std::string_view name = "mesh";
  SharedMesh surface;  // never null
  bool hollow = false;

  /// A point on the surface, to rounding, is on either side.
  bool contains(const Vec3& x) const { return surface->encloses(x) != hollow; }
  double signed_distance(const Vec3& x) const {
    const double distance = surface->nearest(x).distance;
    return contains(x) ? -distance : distance;
  }
  /// Returns the box of its turned box, which is not the tightest.
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

#pragma once
#include <stdexcept>

#include "rigid/shapes/solid.hpp"
#include "rigid/shapes/triangle_mesh.hpp"

namespace silt::rigid {

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
  double ray_distance(const Vec3& o, const Vec3& d, double t_max) const {
    const auto hit = surface->first_hit(o, d, t_max);
    return hit ? hit->t : t_max;
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

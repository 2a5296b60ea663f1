#pragma once
#include <memory>
#include <optional>

#include "rigid/shapes/solid.hpp"
#include "rigid/shapes/triangle_mesh.hpp"

namespace silt::rigid {

/// What a closed surface of triangles encloses, or, if hollow, all that it does not: a vessel. Not convex; a
/// hollow one is for walls only: infinite mass.
struct Mesh {
  static constexpr std::string_view name = "mesh";
  std::shared_ptr<const TriangleMesh> surface;  // never null
  bool hollow = false;

  /// A point on the surface, to rounding, is on either side.
  bool contains(const Vec3& x) const { return surface->encloses(x) != hollow; }
  double signed_distance(const Vec3& x) const;
  double ray_distance(const Vec3& o, const Vec3& d, double t_max) const;
  /// Of its turned box: not the tightest.
  BoundingBox bounding_box(const Pose&) const;
  double bounding_radius() const;
  MassProperties mass_properties() const;
  /// Of its box in the body frame; infinite if hollow.
  double least_width() const;
  Mesh recentred(const Vec3& centre) const;
};

}  // namespace silt::rigid

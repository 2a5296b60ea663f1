#pragma once
#include "rigid/shapes/convex_shape.hpp"

namespace silt::rigid {

struct Part {
  ConvexShape shape;
  Pose pose;  // part to body

  bool operator==(const Part&) const = default;
};

/// Returns the bounding box of one part of a body, in the frame of the body's pose.
BoundingBox part_box(const Part&, const Pose& body);
/// Returns the largest distance of a point of the part from the body's origin.
double reach(const Part&);

/// The union of parts, which may overlap (a star: three capsules crossed at the centre).
struct Compound {
  static constexpr std::string_view name = "compound";
  std::vector<Part> parts;

  bool contains(const Vec3& x) const;
  double signed_distance(const Vec3& x) const;
  BoundingBox bounding_box(const Pose&) const;
  MassProperties mass_properties() const;
  /// Returns the diameter of the sphere of equal volume.
  double least_width() const;
  Compound recentred(const Vec3& centre) const;
};

}  // namespace silt::rigid

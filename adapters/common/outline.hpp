#pragma once
// The side of a box that faces a direction, and what of another shape lies over it.
#include <array>
#include <vector>

#include "adapters/common/rounded_box.hpp"

namespace silt::adapters {

/// The face of a box most nearly normal to a direction: four corners in order, edge i from corner i to i + 1.
struct Face {
  Vec3 normal;
  Feature feature;
  std::array<Vec3, 4> corner;
  std::array<Feature, 4> corner_feature, edge_feature;

  /// How far from x to the face's plane, along unit n.
  double height(const Vec3& x, const Vec3& n) const { return normal.dot(corner[0] - x) / normal.dot(n); }
};
Face face_towards(const RoundedBox& box, const Vec3& direction);

/// A point of the clipped outline with the features of the two shapes it lies on.
struct ClippedPoint {
  Vec3 x;
  Feature of_clipper, of_clipped;
};

/// The corners of the part of `face` that lies over `clipper` when looking along unit n; on the plane of `face`.
/// Points within `slack` (lattice units) outside count as inside.
std::vector<ClippedPoint> clip_face(const Face& clipper, const Face& face, const Vec3& n, double slack);

/// The part of the capsule's segment over `clipper` when looking along n: its two ends, or none.
std::vector<ClippedPoint> clip_segment(const Face& clipper, const RoundedBox& capsule, const Vec3& n, double slack);

}  // namespace silt::adapters

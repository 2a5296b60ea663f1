#pragma once
// The side of a box that faces a direction, and what of another shape lies over it.
#include <array>

#include "rigid/collision/convex_core.hpp"

namespace silt::rigid {

/// The face of a box most nearly normal to a direction: four corners in order, edge i from corner i to i + 1.
struct BoxFace {
  Vec3 normal;
  Feature feature;
  std::array<Vec3, 4> corner;
  std::array<Feature, 4> edge_feature;

  /// How far from x to the face's plane, along unit n.
  double height(const Vec3& x, const Vec3& n) const { return normal.dot(corner[0] - x) / normal.dot(n); }
};
BoxFace face_towards(const ConvexCore& box, const Vec3& direction);

/// A face as seen along unit n (not in its plane): inside are the points with outward[k] . x <= bound[k] for
/// every edge.
struct FacePrism {
  std::array<Vec3, 4> outward;  // unit
  std::array<double, 4> bound;

  double beyond(int k, const Vec3& x) const { return outward[k].dot(x) - bound[k]; }
};
FacePrism prism_over(const BoxFace&, const Vec3& n);

/// What of the face lies under x: the face, or an edge or corner of it that is within `slack` (lattice
/// units).
Feature feature_under(const BoxFace&, const FacePrism&, const Vec3& x, double slack);

/// Corners of a clipped face: four, and one more for each edge it is cut by.
struct Polygon {
  std::array<Vec3, 8> corner;
  int size = 0;

  void add(const Vec3& x) { corner[size++] = x; }
};
/// The part of `face` within the prism (Sutherland, Hodgman, CACM 17 (1974) 32); points within `slack`
/// (lattice units) outside count as inside.
Polygon clip_face(const FacePrism&, const BoxFace& face, double slack);

/// The two ends of a segment, each with the sign of the capsule's end it is, 0 where it was cut.
struct ClippedSegment {
  std::array<Vec3, 2> end;
  std::array<std::int8_t, 2> sign;
  bool empty;
};
/// The part of the capsule's segment within the prism.
ClippedSegment clip_segment(const FacePrism&, const ConvexCore& capsule, double slack);

}  // namespace silt::rigid

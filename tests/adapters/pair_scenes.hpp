#pragma once
// Pairs of shapes to collide, and what their gap is by a method that shares nothing with adapters/.
#include <random>
#include <string>

#include "rigid/shapes/shape.hpp"

namespace silt::tests {

using rigid::ConvexShape;
using rigid::Mat3;
using rigid::Pose;
using rigid::Quat;
using rigid::Vec3;

struct Pair {
  ConvexShape a, b;
  Pose pose_a, pose_b;
};

/// The kinds of shape a pair is made of.
enum class Kind { sphere, box, capsule, cylinder, ellipsoid, polyhedron, half_space };
inline constexpr Kind bodies[] = {Kind::sphere,   Kind::box,       Kind::capsule,
                                  Kind::cylinder, Kind::ellipsoid, Kind::polyhedron};
inline constexpr Kind all_kinds[] = {Kind::sphere,    Kind::box,        Kind::capsule,   Kind::cylinder,
                                     Kind::ellipsoid, Kind::polyhedron, Kind::half_space};
std::string kind_name(Kind);
/// Whether both are a point, a segment or a box swept by a sphere, or the second is a half-space: the
/// reference is a brute-force search of the Minkowski difference, and the backends have closed forms.
inline bool has_closed_form(Kind a, Kind b) {
  const auto swept_box = [](Kind k) { return k == Kind::sphere || k == Kind::box || k == Kind::capsule; };
  return swept_box(a) && (swept_box(b) || b == Kind::half_space);
}

/// Random sizes of 3 to 20 lattice units, orientation, and position near the origin.
ConvexShape random_shape(Kind, std::mt19937_64&);
Quat random_orientation(std::mt19937_64&);
Vec3 random_direction(std::mt19937_64&);

/// A random pair with the reference gap `gap` to 1e-12: b is moved along a random line through a. With a
/// cylinder, ellipsoid or polyhedron: moved along the normal, so that an overlap may turn out less deep.
Pair random_pair(Kind a, Kind b, double gap, std::mt19937_64&);
/// The least size of the two: what overlaps are given relative to.
double smallest_size(const ConvexShape&, const ConvexShape&);

/// The polyhedron whose corners are the points that are corners of their convex hull; coplanar ones share a
/// face.
rigid::Polyhedron hull_of(const std::vector<Vec3>& points);

struct ReferenceGap {
  double gap;
  Vec3 normal;  // from a to b; one of several where the answer is not unique
};
/// The largest distance of two parallel supporting planes, normal from a to b: the signed distance, or minus
/// the depth of overlap. By brute force over the Minkowski difference b - a of the cores' vertices: apart,
/// the least distance of the origin to a triangle of them; overlapping, the nearest plane through three that
/// has all on one side. With a cylinder, ellipsoid or polyhedron: see search_gap. Costs milliseconds.
ReferenceGap reference_gap(const Pair&);

/// n . (support of b along -n - support of a along n), by rigid::support.
double support_gap(const Pair&, const Vec3& n);

}  // namespace silt::tests

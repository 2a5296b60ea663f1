#pragma once
// Pairs of shapes to collide, and what their gap is by a method that shares nothing with adapters/.
#include <random>

#include "tests/shape_rows.hpp"

namespace silt::tests {

using rigid::Mat3;
using rigid::Pose;
using rigid::Quat;

struct Pair {
  ConvexShape a, b;
  Pose pose_a, pose_b;
};

/// The kinds of shape a pair is made of, by name.
using Kind = std::string_view;
inline constexpr Kind half_space = rigid::HalfSpace::name;
inline std::vector<Kind> bodies() {
  std::vector<Kind> names;
  for (const ShapeRow& row : shape_rows()) names.push_back(row.name);
  return names;
}
inline std::vector<Kind> all_kinds() {
  auto names = bodies();
  names.push_back(half_space);
  return names;
}
/// Returns whether both are a point, a segment or a box swept by a sphere, or the second is a half-space: the
/// reference is a brute-force search of the Minkowski difference, and the backends have closed forms.
inline bool has_closed_form(Kind a, Kind b) {
  const auto swept_box = [](Kind k) { return k == "sphere" || k == "box" || k == "capsule"; };
  return swept_box(a) && (swept_box(b) || b == half_space);
}

/// Random sizes of 3 to 20 lattice units, orientation, and position near the origin.
ConvexShape random_shape(Kind, std::mt19937_64&);
Quat random_orientation(std::mt19937_64&);

/// A random pair with the reference gap `gap` to 1e-12: b is moved along a random line through a. With a
/// cylinder, ellipsoid or polyhedron: moved along the normal, so that an overlap may turn out less deep.
Pair random_pair(Kind a, Kind b, double gap, std::mt19937_64&);

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

/// The gap of any two convex shapes by trying directions, a method that shares nothing with adapters/
/// (search_gap.cpp): the largest of s(n) = n . (support_B(-n) - support_A(n)), by rigid::support, which has
/// its maximum either where two edges or a face fix n (all of them are tried), or on the great circle normal
/// to an edge (each is sampled, the best places refined by golden sections), or where s is smooth (a grid of
/// directions, the best of them refined by the method of Nelder and Mead).
ReferenceGap search_gap(const Pair&);

}  // namespace silt::tests

#pragma once
// What a convex shape says of itself. Its own frame and lattice units throughout; directions are unit
// vectors. README.md of this folder says how to add one.
#include <concepts>
#include <optional>
#include <string_view>
#include <vector>

#include "rigid/shapes/bounding_box.hpp"
#include "rigid/shapes/contact_outline.hpp"
#include "rigid/shapes/field.hpp"
#include "rigid/shapes/line_interval.hpp"
#include "rigid/shapes/mass_properties.hpp"

namespace silt::rigid {

/// A ball inside a shape; radius 0: a point of it.
struct InnerBall {
  Vec3 centre;
  double radius;
};

/// Projects onto the plane across unit n.
inline Mat3 across(const Vec3& n) {
  return Mat3::Identity() - n * n.transpose();
}

/// What every convex shape has to tell:
/// - name: what a case calls its type;
/// - fields: a tuple of Field, its sizes as a case gives them;
/// - signed_distance(x): from x to the surface, negative inside; exact;
/// - line_interval(o, d): the part of the line o + t d inside it; none where the line misses; exact for any
/// d;
/// - bounding_box(pose): the tight one along the axes of the frame that the pose is given in;
/// - reach(pose): how far its furthest point is from that frame's origin;
/// - support(n): its point furthest along unit n;
/// - ==: whether it is the same, to the bit (compounds are known by it);
/// - mass_properties();
/// - least_width(): between two parallel planes that touch it, the least, or a length near it;
/// - add_inner_balls(balls): balls and points inside it that together stand for it
/// (coupler/placement/overlap.hpp).
template <class S>
concept ConvexSolid = requires(const S& s, const Vec3& x, const Pose& pose, std::vector<InnerBall>& balls) {
  requires std::equality_comparable<S>;
  { S::name } -> std::convertible_to<std::string_view>;
  std::tuple_size<std::remove_cvref_t<decltype(S::fields)>>::value;
  { s.signed_distance(x) } -> std::same_as<double>;
  { s.line_interval(x, x) } -> std::same_as<std::optional<LineInterval>>;
  { s.bounding_box(pose) } -> std::same_as<BoundingBox>;
  { s.reach(pose) } -> std::same_as<double>;
  { s.support(x) } -> std::same_as<Vec3>;
  { s.mass_properties() } -> std::same_as<MassProperties>;
  { s.least_width() } -> std::same_as<double>;
  s.add_inner_balls(balls);
};

}  // namespace silt::rigid

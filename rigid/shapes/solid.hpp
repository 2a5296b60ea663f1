#pragma once
// What a convex shape says of itself. Its own frame and lattice units throughout; directions are unit
// vectors. README.md of this folder says how to add one.
#include <algorithm>
#include <concepts>
#include <limits>
#include <optional>
#include <string_view>
#include <tuple>
#include <vector>

#include "rigid/shapes/bounding_box.hpp"
#include "rigid/shapes/contact_outline.hpp"
#include "rigid/shapes/line_interval.hpp"
#include "rigid/shapes/mass_properties.hpp"

namespace silt::rigid {

/// How a case gives a size of a shape: an entry of its table `fields`. A length, or for a member that is a
/// vector three lengths along the axes. member = share * what `key` gives, or other_share * what `other_key`
/// gives, where there is one; the case has one of the two.
template <class Solid, class Value>
struct Field {
  const char* key;
  Value Solid::*member;
  const char* doc;  // ends the message that it is missing
  double share = 1;
  const char* other_key = nullptr;
  double other_share = 1;
};

template <class Solid>
constexpr Field<Solid, double> radius_field(double Solid::*radius) {
  return {"radius", radius, "how large it is", 1, "diameter", 0.5};
}

/// A ball inside a shape; radius 0: a point of it.
struct InnerBall {
  Vec3 centre;
  double radius;
};

/// The radius of the largest ball that touches the plane normal to unit n at a point from below and stays
/// below the planes added: it proves a depth of overlap the least one (rigid/collision/depth_proof.cpp).
struct BallUnderPlanes {
  explicit BallUnderPlanes(const Vec3& normal) : n(normal) {}

  /// A plane with unit `outward` normal, which the point is `below` it (lattice units).
  void add(const Vec3& outward, double below) {
    const double turned = (outward - n).squaredNorm() / 2;  // 1 - cosine
    if (turned > same_plane) radius = std::min(radius, std::max(below, 0.0) / turned);
  }

  Vec3 n;
  double radius = std::numeric_limits<double>::infinity();

 private:
  /// Half the square of an angle below which two directions are one.
  static constexpr double same_plane = 1e-18;
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

// What a shape need not tell of itself, since it follows from what it does tell. A shape that has a member of
// the same name is asked instead: it is faster, or knows better. rigid/collision/convex_core does the same
// with what a search for contacts asks.
namespace solid {

/// Whether x is inside or on the surface.
template <class S>
bool contains(const S& s, const Vec3& x) {
  if constexpr (requires { s.contains(x); })
    return s.contains(x);
  else
    return s.signed_distance(x) <= 0;
}

/// From o, outside, along the ray o + t d to the surface: t, at most t_max.
template <class S>
double ray_distance(const S& s, const Vec3& o, const Vec3& d, double t_max) {
  if constexpr (requires { s.ray_distance(o, d, t_max); }) {
    return s.ray_distance(o, d, t_max);
  } else {
    const auto inside = s.line_interval(o, d);
    if (!inside || inside->leave < 0) return t_max;
    return std::clamp(inside->enter, 0.0, t_max);
  }
}

/// The same shape about its centre of mass: itself where that is its origin.
template <class S>
S recentred(const S& s, const Vec3& centre) {
  if constexpr (requires { s.recentred(centre); })
    return s.recentred(centre);
  else
    return s;
}

}  // namespace solid

}  // namespace silt::rigid

#pragma once
// The interface of a convex shape. It uses its own frame and lattice units throughout; directions are unit
// vectors. README.md of this folder says how to add a shape.
#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <tuple>
#include <vector>

#include "rigid/math/types.hpp"
#include "rigid/shapes/mass_properties.hpp"
#include "rigid/shapes/surface_kinds.hpp"

namespace silt::rigid {

/// The place of a shape in the world frame of a query, in lattice units.
struct Placement {
  Vec3 centre;
  Mat3 axes;  // columns: the unit axes of the body

  Vec3 to_world(const Vec3& x_B) const { return centre + axes * x_B; }
  Vec3 direction_B(const Vec3& n) const { return axes.transpose() * n; }
};

/// Directions in which the boundary of a core is not smooth, near a given one; world frame, unit vectors.
struct Kinks {
  /// Axes of circles, of the directions normal to them: along a straight edge, or a line of a cylinder's
  /// side.
  std::vector<Vec3> circles;
  std::vector<Vec3> faces;  // outward normals
  void clear() {
    circles.clear();
    faces.clear();
  }
};

/// One corner: a point. Two: a line. Three and more: a flat face, counter-clockwise or clockwise, or a disc
/// through the corners. Codes are below 2^16 and unique for a shape; they are those of Feature for boxes and
/// capsules, and of the body's own frame for the others, so they stay while the same feature touches.
struct ContactOutline {
  struct Corner {
    Vec3 x;
    std::uint32_t code, edge_code;  // edge: the one to the next corner
  };
  std::vector<Corner> corners;
  std::uint32_t code = 0;      // of what lies between the corners
  Vec3 normal = Vec3::Zero();  // outward, unit, of three corners and more
  Vec3 centre = Vec3::Zero();  // of a disc
  double disc_radius = 0;      // 0: not a disc
  double barrel_radius = 0;    // of the barrel about the third axis that a line lies on; 0: on none

  std::size_t size() const { return corners.size(); }
  bool is_face() const { return size() > 2; }
  const Corner& next(std::size_t k) const { return corners[k + 1 < size() ? k + 1 : 0]; }
  /// Returns the distance from x to the face's plane, along unit n.
  double height(const Vec3& x, const Vec3& n) const { return normal.dot(corners[0].x - x) / normal.dot(n); }
  void reset() {
    corners.clear();
    disc_radius = barrel_radius = 0;
  }
  void set_point(const Vec3& x, std::uint32_t point_code) {
    reset();
    corners.push_back({x, point_code, point_code});
    code = point_code;
  }
};

/// A point of a shape that may touch a plane.
struct PlanePoint {
  Vec3 x;
  std::uint32_t code;
  bool only_if_lowest = false;  // it moves over the surface, and counts only where no other is as low
};

struct LineInterval {
  double enter, leave;  // parameters along the line, enter <= leave; may be infinite

  static LineInterval everything() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return {-infinity, infinity};
  }
};

/// Returns the interval where a t^2 + 2 b t + c <= 0, for a > 0: its real roots, without cancellation.
inline std::optional<LineInterval> between_roots(double a, double b, double c) {
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return {};
  const double s = std::sqrt(discriminant);
  const double q = b >= 0 ? -b - s : -b + s;
  const double t1 = q / a, t2 = q != 0 ? c / q : 0.0;
  return LineInterval{std::min(t1, t2), std::max(t1, t2)};
}

/// Returns the interval where |o + t d| <= half_width along one axis.
inline std::optional<LineInterval> in_slab(double o, double d, double half_width) {
  using Interval = std::optional<LineInterval>;
  if (d == 0) return std::abs(o) <= half_width ? Interval{LineInterval::everything()} : Interval{};
  const double t1 = (-half_width - o) / d, t2 = (half_width - o) / d;
  return LineInterval{std::min(t1, t2), std::max(t1, t2)};
}

inline std::optional<LineInterval> in_both(const std::optional<LineInterval>& a,
                                           const std::optional<LineInterval>& b) {
  if (!a || !b) return {};
  const LineInterval i{std::max(a->enter, b->enter), std::min(a->leave, b->leave)};
  return i.enter <= i.leave ? std::optional{i} : std::nullopt;
}

/// Returns the interval in the ball about the origin.
inline std::optional<LineInterval> in_ball(double radius, const Vec3& o, const Vec3& d) {
  const double distance = o.norm();  // the difference of squares, factored: exact close to the surface
  return between_roots(d.squaredNorm(), o.dot(d), (distance - radius) * (distance + radius));
}

/// An entry of a shape's table `fields` says how a case gives a size: a length, or for a member that is a
/// vector three lengths along the axes. member = share * the value of `key`, or other_share * that of
/// `other_key`, if there is one; the case has one of the two.
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
/// below the planes added: it proves a depth of overlap the least one
/// (rigid/collision/deepest_direction.cpp).
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

/// Says whether a face's outward normal is that of a contact, up to what bodies that lie flat rock by.
inline bool is_along(const Vec3& face, const Vec3& n) {
  constexpr double sine = 0.01;
  return face.dot(n) > 0 && face.cross(n).squaredNorm() <= sine * sine;
}

/// Projects onto the plane across unit n.
inline Mat3 across(const Vec3& n) {
  return Mat3::Identity() - n * n.transpose();
}

/// Every convex shape has the following members:
/// - name: what a case calls its type;
/// - fields: a tuple of Field, its sizes as a case gives them;
/// - signed_distance(x): from x to the surface, negative inside; exact;
/// - line_interval(o, d): the part of the line o + t d inside it; none where the line misses; exact for any
/// d;
/// - bounding_box(pose): the tight one along the axes of the frame that the pose is given in;
/// - reach(pose): how far its furthest point is from that frame's origin;
/// - support(n): its point furthest along unit n;
/// - curvature(x, n): rigid::curvature (convex_shape.hpp);
/// - ==: whether it is bitwise the same (compounds are known by it);
/// - mass_properties();
/// - least_width(): between two parallel planes that touch it, the least, or a length near it;
/// - add_inner_balls(balls): balls and points inside it that together stand for it
/// (silt/placement/obstacles.hpp);
/// - surface(parts): adds what it is made of to SurfaceParts, by kinds of surface_kinds.hpp;
/// - extremes(use): calls use.ball, use.disc or use.ellipsoid for those that it is the hull of
/// (rigid/collision/tube_contacts.cpp).
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
  { s.curvature(x, x) } -> std::convertible_to<std::optional<Mat3>>;
  { s.mass_properties() } -> std::same_as<MassProperties>;
  { s.least_width() } -> std::same_as<double>;
  s.add_inner_balls(balls);
};

// These functions follow from the members that every shape has. A shape that has a member of the same name is
// asked instead: it is faster, or knows better. rigid/collision/convex_core does the same for the search for
// contacts.
namespace solid {

/// Says whether x is inside or on the surface.
template <class S>
bool contains(const S& s, const Vec3& x) {
  if constexpr (requires { s.contains(x); })
    return s.contains(x);
  else
    return s.signed_distance(x) <= 0;
}

/// Returns the shape about its centre of mass: itself where that is its origin.
template <class S>
S recentred(const S& s, const Vec3& centre) {
  if constexpr (requires { s.recentred(centre); })
    return s.recentred(centre);
  else
    return s;
}

}  // namespace solid

}  // namespace silt::rigid

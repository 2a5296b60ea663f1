#pragma once
// The interface of a convex shape: all quantities in the shape's own frame and lattice units, directions as
// unit vectors. README.md of this folder says how to add a shape.
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

/// The pose of a shape in the frame of a query, in lattice units.
struct Placement {
  Vec3 centre;
  Mat3 axes;  // columns: the unit axes of the body

  Vec3 to_world(const Vec3& x_B) const { return centre + axes * x_B; }
  Vec3 direction_B(const Vec3& n) const { return axes.transpose() * n; }
};

/// Directions near a given one in which the support function is not smooth; world frame, unit vectors.
struct Kinks {
  /// Axes of great circles of such directions: along a straight edge, or along a cylinder's side.
  std::vector<Vec3> circles;
  std::vector<Vec3> faces;  // outward normals
  void clear() {
    circles.clear();
    faces.clear();
  }
};

/// The part of a shape's surface that meets another body: a point (one corner), a line (two), or a flat face
/// (more, in either orientation) or a disc through the corners. Codes are below 2^16 and unique within a
/// shape. They are fixed to the body (for boxes and capsules those of Feature) and persist over steps.
struct ContactOutline {
  struct Corner {
    Vec3 x;
    std::uint32_t code, edge_code;  // edge_code: of the edge to the next corner
  };
  std::vector<Corner> corners;
  std::uint32_t code = 0;      // of the line or face between the corners
  Vec3 normal = Vec3::Zero();  // outward, unit; set for three corners and more
  Vec3 centre = Vec3::Zero();  // of a disc
  double disc_radius = 0;      // 0: not a disc
  double barrel_radius = 0;    // of the cylinder about z on which a line lies; 0: none

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

/// A candidate point of a shape for contact with a plane.
struct PlanePoint {
  Vec3 x;
  std::uint32_t code;
  bool only_if_lowest = false;  // a point that moves over the surface; used if no other is as low
};

struct LineInterval {
  double enter, leave;  // parameters along the line, enter <= leave; may be infinite

  static LineInterval everything() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return {-infinity, infinity};
  }
};

/// Returns the interval where a t^2 + 2 b t + c <= 0, a > 0, computed without cancellation.
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
  const double distance = o.norm();  // the difference of squares is factored: exact near the surface
  return between_roots(d.squaredNorm(), o.dot(d), (distance - radius) * (distance + radius));
}

/// An entry of a shape's table `fields`: a size as a case gives it, a length or three lengths along the axes.
/// member = share * the value of `key`, or other_share * that of `other_key`; a case gives exactly one key.
template <class Solid, class Value>
struct Field {
  const char* key;
  Value Solid::*member;
  const char* doc;  // end of the error message for a missing key
  double share = 1;
  const char* other_key = nullptr;
  double other_share = 1;
};

template <class Solid>
constexpr Field<Solid, double> radius_field(double Solid::*radius) {
  return {"radius", radius, "how large it is", 1, "diameter", 0.5};
}

/// A ball inside a shape; with radius 0 a point.
struct InnerBall {
  Vec3 centre;
  double radius;
};

/// Computes the radius of the largest ball that touches, from below, the plane normal to unit n at a point
/// and stays below all added planes. It proves that a penetration depth is the least
/// (rigid/collision/deepest_direction.cpp).
struct BallUnderPlanes {
  explicit BallUnderPlanes(const Vec3& normal) : n(normal) {}

  /// Adds a plane with unit normal `outward`; the point is at distance `below` under it (lattice units).
  void add(const Vec3& outward, double below) {
    const double turned = (outward - n).squaredNorm() / 2;  // 1 - cosine
    if (turned > same_plane) radius = std::min(radius, std::max(below, 0.0) / turned);
  }

  Vec3 n;
  double radius = std::numeric_limits<double>::infinity();

 private:
  /// Half the square of the angle below which two directions count as equal.
  static constexpr double same_plane = 1e-18;
};

/// Returns whether a face's outward normal is the contact normal, up to the small rocking of bodies that lie
/// flat.
inline bool is_along(const Vec3& face, const Vec3& n) {
  constexpr double sine = 0.01;
  return face.dot(n) > 0 && face.cross(n).squaredNorm() <= sine * sine;
}

/// Returns the projection onto the plane normal to unit n.
inline Mat3 across(const Vec3& n) {
  return Mat3::Identity() - n * n.transpose();
}

/// Every convex shape has the following members:
/// - name: its type in a case;
/// - fields: a tuple of Field, its sizes as a case gives them;
/// - signed_distance(x): the exact distance from x to the surface, negative inside;
/// - line_interval(o, d): the part of the line o + t d inside it, exact for any d; none where the line
/// misses;
/// - bounding_box(pose): the tight axis-aligned box in the frame of the pose;
/// - reach(pose): the largest distance of its points from that frame's origin;
/// - support(n): its point furthest along unit n;
/// - curvature(x, n): rigid::curvature (shape.hpp);
/// - ==: bitwise equality (the cache of compounds uses it);
/// - mass_properties();
/// - least_width(): the least distance of two parallel planes that enclose it, or an estimate;
/// - add_inner_balls(balls): adds balls and points that represent it (silt/placement/obstacles.hpp);
/// - surface(parts): adds its parts to SurfaceParts, as kinds of surface_kinds.hpp;
/// - extremes(use): calls use.ball, use.disc or use.ellipsoid for the solids whose convex hull it is
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

// Defaults that follow from the members above. A member function of the same name replaces a default.
// rigid/collision/convex_core does so, too.
namespace solid {

/// Returns whether x is inside or on the surface.
template <class S>
bool contains(const S& s, const Vec3& x) {
  if constexpr (requires { s.contains(x); })
    return s.contains(x);
  else
    return s.signed_distance(x) <= 0;
}

/// Returns the shape about its centre of mass: itself unless it has a member recentred.
template <class S>
S recentred(const S& s, const Vec3& centre) {
  if constexpr (requires { s.recentred(centre); })
    return s.recentred(centre);
  else
    return s;
}

}  // namespace solid

}  // namespace silt::rigid

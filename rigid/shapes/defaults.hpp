#pragma once
// What a shape need not tell of itself, since it follows from what it does tell. A shape that has a member of
// the same name is asked instead: it is faster, or knows better.
#include <array>

#include "rigid/shapes/box.hpp"
#include "rigid/shapes/solid.hpp"

namespace silt::rigid::solid {

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

/// The shape whose sweep by a ball of core_radius it is.
template <class S>
decltype(auto) core(const S& s) {
  if constexpr (requires { s.core(); })
    return s.core();
  else
    return (s);
}
template <class S>
double core_radius(const S& s) {
  if constexpr (requires { s.core_radius(); })
    return s.core_radius();
  else
    return 0;
}

/// Whether it is the hull of its corners: the supporting point stays where the direction changes a little.
template <class S>
constexpr bool is_polytope = requires {
  S::is_polytope;
};

/// Half the widths of a box about the origin that it is in.
template <class S>
Vec3 half_widths(const S& s) {
  if constexpr (requires { s.half_widths(); }) {
    return s.half_widths();
  } else {
    Vec3 half;
    for (int k = 0; k < 3; ++k)
      half[k] = std::max(s.support(Vec3::Unit(k))[k], -s.support(-Vec3::Unit(k))[k]);
    return half;
  }
}

/// Derivative of the supporting point by unit n, the supporting feature kept; by central differences.
template <class S>
Mat3 support_derivative(const S& s, const Vec3& n) {
  if constexpr (requires { s.support_derivative(n); }) {
    return s.support_derivative(n);
  } else if constexpr (is_polytope<S>) {
    return Mat3::Zero();
  } else {
    constexpr double step = 1e-5;  // radian: rounding and the third derivative weigh about alike
    const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
    Mat3 k = Mat3::Zero();
    for (const Vec3& t : {u, v})
      k += (s.support((n + step * t).normalized()) - s.support((n - step * t).normalized())) *
           (t / (2 * step)).transpose();
    return k;
  }
}

/// Adds the circles of directions within `angle` (radian) of n where the supporting feature changes, and the
/// normals of flat faces that near n. None.
template <class S>
void kinks(const S& s, const Placement& at, const Vec3& n_B, double angle, Kinks& out) {
  if constexpr (requires { s.kinks(at, n_B, angle, out); }) s.kinks(at, n_B, angle, out);
}

/// Radius of a ball inside that touches the boundary at x, where unit n is an outward normal; 0 at edges and
/// corners. At most the largest there is: 0 is always right, and costs the proof of a depth of overlap.
template <class S>
double touching_ball(const S& s, const Vec3& x, const Vec3& n) {
  if constexpr (requires { s.touching_ball(x, n); })
    return s.touching_ball(x, n);
  else
    return 0;
}

/// Whether it looks the same however it is turned about its third axis.
template <class S>
constexpr bool is_revolved = requires {
  S::is_revolved;
};

/// A ball inside, near x, as large as it goes: radius 0 is always right, and costs the proof of a depth of
/// overlap.
template <class S>
InnerBall inner_ball(const S& s, const Vec3& x) {
  if constexpr (requires { s.inner_ball(x); })
    return s.inner_ball(x);
  else
    return {Vec3::Zero(), 0};
}

/// How many codes its outlines use.
template <class S>
std::size_t codes(const S& s) {
  if constexpr (requires { s.codes(); })
    return s.codes();
  else
    return 64;
}

/// What of it is furthest along unit n, up to `slack` (lattice units): the supporting point.
template <class S>
void touching_outline(const S& s, const Placement& at, const Vec3& n, double slack, ContactOutline& out) {
  if constexpr (requires { s.touching_outline(at, n, slack, out); })
    s.touching_outline(at, n, slack, out);
  else
    out.set_point(at.to_world(s.support(at.direction_B(n))), 0);
}

/// The face or the line of it that looks along unit n, at whatever angle: the supporting point.
template <class S>
void facing_outline(const S& s, const Placement& at, const Vec3& n, ContactOutline& out) {
  if constexpr (requires { s.facing_outline(at, n, out); })
    s.facing_outline(at, n, out);
  else
    out.set_point(at.to_world(s.support(at.direction_B(n))), 0);
}

/// Adds the points that may touch a plane normal to unit n, in the order of their codes: the supporting
/// point.
template <class S>
void plane_points(const S& s, const Placement& at, const Vec3& n, std::vector<PlanePoint>& out) {
  if constexpr (requires { s.plane_points(at, n, out); })
    s.plane_points(at, n, out);
  else
    out.push_back({at.to_world(s.support(at.direction_B(n))), 0});
}

}  // namespace silt::rigid::solid

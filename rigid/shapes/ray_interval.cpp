#include "rigid/shapes/ray_interval.hpp"

#include <cmath>
#include <limits>

namespace silt::rigid {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
using Interval = std::optional<RayInterval>;

/// Real roots of a t^2 + 2 b t + c, a > 0, without cancellation.
Interval roots(double a, double b, double c) {
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return {};
  const double s = std::sqrt(discriminant);
  const double q = b >= 0 ? -b - s : -b + s;
  const double t1 = q / a, t2 = q != 0 ? c / q : 0.0;
  return RayInterval{std::min(t1, t2), std::max(t1, t2)};
}

/// |o_d + t d_d| <= half_width along one axis.
Interval slab(double o, double d, double half_width) {
  if (d == 0) return std::abs(o) <= half_width ? Interval{RayInterval{-infinity, infinity}} : Interval{};
  const double t1 = (-half_width - o) / d, t2 = (half_width - o) / d;
  return RayInterval{std::min(t1, t2), std::max(t1, t2)};
}

Interval intersect(const Interval& a, const Interval& b) {
  if (!a || !b) return {};
  const RayInterval i{std::max(a->enter, b->enter), std::min(a->leave, b->leave)};
  return i.enter <= i.leave ? Interval{i} : Interval{};
}

Interval sphere(double radius, const Vec3& o, const Vec3& d) {
  const double distance = o.norm();  // the difference of squares, factored: exact close to the surface
  return roots(d.squaredNorm(), o.dot(d), (distance - radius) * (distance + radius));
}

struct LineInside {
  const Vec3 &o, &d;

  Interval operator()(const Sphere& s) const { return sphere(s.radius, o, d); }
  Interval operator()(const Box& b) const {
    return intersect(intersect(slab(o[0], d[0], b.half_edges[0]), slab(o[1], d[1], b.half_edges[1])),
                     slab(o[2], d[2], b.half_edges[2]));
  }
  Interval operator()(const Capsule& c) const {
    const double a = d[0] * d[0] + d[1] * d[1], rho = std::sqrt(o[0] * o[0] + o[1] * o[1]);
    if (!(a > 0)) return rho <= c.radius ? along_axis(c, rho) : Interval{};
    const Interval barrel = roots(a, o[0] * d[0] + o[1] * d[1], (rho - c.radius) * (rho + c.radius));
    if (!barrel) return {};
    // Where the line crosses the endless barrel beyond the segment, it enters or leaves through that end's
    // cap or not at all.
    const auto end = [&](double t, bool entering) -> std::optional<double> {
      const double z = o[2] + t * d[2];
      if (std::abs(z) <= c.half_length) return t;
      const Interval cap = sphere(c.radius, o - Vec3(0, 0, std::copysign(c.half_length, z)), d);
      if (!cap) return {};
      return entering ? cap->enter : cap->leave;
    };
    const auto enter = end(barrel->enter, true);
    if (!enter) return {};
    const auto leave = end(barrel->leave, false);
    if (!leave) return {};
    return RayInterval{*enter, *leave};
  }
  /// A line parallel to the capsule's axis at distance rho <= radius.
  Interval along_axis(const Capsule& c, double rho) const {
    const double reach = c.half_length + std::sqrt((c.radius - rho) * (c.radius + rho));
    return slab(o[2], d[2], reach);
  }
  Interval operator()(const Cylinder& c) const {
    const double a = d[0] * d[0] + d[1] * d[1], rho = std::sqrt(o[0] * o[0] + o[1] * o[1]);
    const Interval between_ends = slab(o[2], d[2], c.half_length);
    if (!(a > 0)) return rho <= c.radius ? between_ends : Interval{};
    const double b = o[0] * d[0] + o[1] * d[1];
    return intersect(roots(a, b, (rho - c.radius) * (rho + c.radius)), between_ends);
  }
  /// Seen in the coordinates in which it is the unit sphere.
  Interval operator()(const Ellipsoid& e) const {
    const Vec3 p = o.cwiseQuotient(e.half_axes), v = d.cwiseQuotient(e.half_axes);
    const double a = v.squaredNorm(), b = p.dot(v), distance = p.norm();
    const double closest =
        (p - b / a * v).norm();  // the line passes the centre at: keeps far, grazing rays exact
    if (!(closest <= 1)) return {};
    const double s = std::sqrt(a * (1 - closest) * (1 + closest)), q = b >= 0 ? -b - s : -b + s;
    const double t1 = q / a, t2 = q != 0 ? (distance - 1) * (distance + 1) / q : 0.0;
    return RayInterval{std::min(t1, t2), std::max(t1, t2)};
  }
  /// Clipped by the plane of one face after the other.
  Interval operator()(const Polyhedron& q) const {
    RayInterval inside{-infinity, infinity};
    for (const auto& face : q.mesh->faces) {
      const double height = face.normal.dot(o) - face.offset, speed = face.normal.dot(d);
      if (speed == 0 && height > 0) return {};
      if (speed < 0) inside.enter = std::max(inside.enter, -height / speed);
      if (speed > 0) inside.leave = std::min(inside.leave, -height / speed);
    }
    return inside.enter <= inside.leave ? Interval{inside} : Interval{};
  }
  Interval operator()(const HalfSpace& h) const {
    const double distance = h.normal.dot(o), speed = h.normal.dot(d);
    if (speed == 0) return distance <= 0 ? Interval{RayInterval{-infinity, infinity}} : Interval{};
    const double t = -distance / speed;
    return speed < 0 ? RayInterval{t, infinity} : RayInterval{-infinity, t};
  }
};

}  // namespace

std::optional<RayInterval> hollow_interval(const Tube& tube, const Vec3& o, const Vec3& d) {
  const double a = d[0] * d[0] + d[1] * d[1], rho = std::sqrt(o[0] * o[0] + o[1] * o[1]);
  if (!(a > 0)) return rho < tube.radius ? Interval{RayInterval{-infinity, infinity}} : Interval{};
  return roots(a, o[0] * d[0] + o[1] * d[1], (rho - tube.radius) * (rho + tube.radius));
}

std::optional<RayInterval> ray_interval(const ConvexShape& shape, const Vec3& origin_B,
                                        const Vec3& direction_B) {
  return std::visit(LineInside{origin_B, direction_B}, shape);
}

}  // namespace silt::rigid

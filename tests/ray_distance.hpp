#pragma once
// How far along a ray a shape is, by the shape itself: what mapping and contacts are compared with.
#include <algorithm>
#include <cmath>

#include "rigid/shapes/shape.hpp"

namespace silt::tests {

/// Returns the smallest t in [0, t_max] with o + t d on the surface, for o outside the solid; t_max where
/// there is none. Closed forms, exact, but of a mesh with the rounding of its triangles. d need not be a unit
/// vector.
inline double ray_distance(const rigid::Shape& shape, const rigid::Vec3& o, const rigid::Vec3& d,
                           double t_max) {
  if (const auto* mesh = std::get_if<rigid::Mesh>(&shape)) {
    const auto hit = mesh->surface->first_hit(o, d, t_max);
    return hit ? hit->t : t_max;
  }
  if (const auto* tube = std::get_if<rigid::Tube>(&shape)) {
    const double a = d[0] * d[0] + d[1] * d[1], rho = std::sqrt(o[0] * o[0] + o[1] * o[1]), R = tube->radius;
    if (!(a > 0)) return rho < R ? t_max : 0.0;
    const auto hole = rigid::between_roots(a, o[0] * d[0] + o[1] * d[1], (rho - R) * (rho + R));
    return hole ? std::clamp(hole->leave, 0.0, t_max) : 0.0;
  }
  double t = t_max;
  for (const rigid::Part& part : rigid::convex_parts(shape)) {
    const auto inside =
        rigid::line_interval(part.shape, part.pose.to_body(o), part.pose.orientation.conjugate() * d);
    if (inside && inside->leave >= 0) t = std::clamp(inside->enter, 0.0, t);
  }
  return t;
}

}  // namespace silt::tests

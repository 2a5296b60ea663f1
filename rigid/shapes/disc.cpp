#include "rigid/shapes/disc.hpp"

#include <numbers>

namespace silt::rigid {

ContactOutline::Corner Disc::lowest(const Placement& at, const Vec3& n) const {
  const Vec3 d = at.direction_B(n);
  const double across = elementary::hypot(d.x(), d.y()), scale = across > 0 ? radius / across : 0;
  const std::uint32_t code = first_lowest + (side > 0);
  return {at.to_world({scale * d.x(), scale * d.y(), z}), code, code};
}

void Disc::outline(const Placement& at, ContactOutline& out) const {
  out.reset();
  const int upper = side > 0;
  out.code = first_end + upper;
  out.normal = side * at.axes.col(2);
  out.centre = at.to_world({0, 0, z});
  out.disc_radius = radius;
  for (int k = 0; k < rim_points; ++k) {
    const double angle = 2 * std::numbers::pi * k / rim_points;
    const Vec3 x = out.centre + out.disc_radius * (elementary::cos(angle) * at.axes.col(0) +
                                                   elementary::sin(angle) * at.axes.col(1));
    const std::uint32_t which = upper * rim_points + k;
    out.corners.push_back({x, first_rim + which, first_chord + which});
  }
}

void Disc::add_plane_points(const Placement& at, const Vec3& n, std::vector<PlanePoint>& out) const {
  const bool flat = is_flat_against(at.direction_B(n));
  if (flat) {
    thread_local ContactOutline end;
    outline(at, end);
    for (const auto& corner : end.corners) out.push_back({corner.x, corner.code});
  }
  const auto corner = lowest(at, n);
  out.push_back({corner.x, corner.code, flat});
}

Mat3 rim_derivative(double radius, const Vec3& n) {
  const double across = elementary::hypot(n.x(), n.y());
  if (!(across > 0)) return Mat3::Zero();
  const Vec3 tangent(-n.y() / across, n.x() / across, 0);
  return radius / across * tangent * tangent.transpose();
}

}  // namespace silt::rigid

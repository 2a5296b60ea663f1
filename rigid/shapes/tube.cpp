#include "rigid/shapes/tube.hpp"

#include <numbers>

namespace silt::rigid {

double Tube::ray_distance(const Vec3& o, const Vec3& d, double t_max) const {
  const double a = d[0] * d[0] + d[1] * d[1], rho = std::sqrt(o[0] * o[0] + o[1] * o[1]);
  if (!(a > 0)) return rho < radius ? t_max : 0.0;
  const auto hole = between_roots(a, o[0] * d[0] + o[1] * d[1], (rho - radius) * (rho + radius));
  return hole ? std::clamp(hole->leave, 0.0, t_max) : 0.0;
}

BoundingBox Tube::hole(const Pose& at) const {
  constexpr double straight = 1e-12;  // rounding of a unit vector
  const Vec3 axis = at.orientation * Vec3::UnitZ();
  Vec3 half = Vec3::Constant(radius);
  for (int d = 0; d < 3; ++d)
    if (std::abs(axis[d]) > straight) half[d] = std::numeric_limits<double>::infinity();
  return BoundingBox::around(at.position, half);
}

double Tube::area(const Vec3& axis, const Vec3& size) const {
  return 2 * std::numbers::pi * radius * axis.cwiseAbs().dot(size);
}

}  // namespace silt::rigid

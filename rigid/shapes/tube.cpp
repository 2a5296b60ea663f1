#include "rigid/shapes/tube.hpp"

namespace silt::rigid {

std::optional<LineInterval> Tube::hollow_interval(const Vec3& o, const Vec3& d) const {
  const double a = d[0] * d[0] + d[1] * d[1], rho = std::sqrt(o[0] * o[0] + o[1] * o[1]);
  if (!(a > 0)) return rho < radius ? std::optional{LineInterval::everything()} : std::nullopt;
  return between_roots(a, o[0] * d[0] + o[1] * d[1], (rho - radius) * (rho + radius));
}

/// To where the line leaves the hollow.
double Tube::ray_distance(const Vec3& o, const Vec3& d, double t_max) const {
  const auto hollow = hollow_interval(o, d);
  return hollow ? std::clamp(hollow->leave, 0.0, t_max) : 0.0;
}

}  // namespace silt::rigid

#include "rigid/shapes/sphere.hpp"

#include <numbers>

namespace silt::rigid {

MassProperties Sphere::mass_properties() const {
  const double volume = 4.0 / 3 * std::numbers::pi * radius * radius * radius;
  return {volume, Vec3::Zero(), 0.4 * volume * radius * radius * Mat3::Identity()};
}

Mat3 Sphere::curvature(const Vec3&, const Vec3& n) const {
  return across(n) / radius;
}

}  // namespace silt::rigid

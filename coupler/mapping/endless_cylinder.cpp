#include "coupler/mapping/endless_cylinder.hpp"

#include <cmath>

namespace silt::coupler {

std::optional<rigid::Shape> endless_cylinder(const rigid::Shape& shape, const rigid::Pose& pose,
                                             const rigid::Vec3& periods) {
  constexpr double nearly = 1 - 1e-9;
  const auto* const given = std::get_if<rigid::Cylinder>(&shape);
  if (!given) return std::nullopt;
  const rigid::Vec3 along = pose.orientation * rigid::Vec3(rigid::Vec3::UnitZ());
  for (int d = 0; d < 3; ++d)
    if (periods[d] > 0 && std::abs(along[d]) > nearly && 2 * given->half_length > nearly * periods[d])
      return rigid::Cylinder{given->radius, given->half_length + periods[d]};
  return std::nullopt;
}

}  // namespace silt::coupler

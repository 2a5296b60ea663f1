#include "coupler/mapping/endless_shape.hpp"

#include <cmath>

namespace silt::coupler {

namespace {

constexpr double rounding = 1e-9;  // of directions; of lengths, relative to the period

/// Adds the period to half of a length along axis k of a body where it reaches its image.
void lengthen(double& half, int k, const rigid::Pose& pose, const rigid::Vec3& periods) {
  const rigid::Vec3 along = pose.orientation * rigid::Vec3(rigid::Vec3::Unit(k));
  for (int d = 0; d < 3; ++d)
    if (periods[d] > 0 && std::abs(along[d]) > 1 - rounding && 2 * half > (1 - rounding) * periods[d])
      return void(half += periods[d]);
}

}  // namespace

std::optional<rigid::Shape> endless_shape(const rigid::Shape& shape, const rigid::Pose& pose,
                                          const rigid::Vec3& periods) {
  if (const auto* given = std::get_if<rigid::Cylinder>(&shape)) {
    rigid::Cylinder longer = *given;
    lengthen(longer.half_length, 2, pose, periods);
    if (!(longer == *given)) return longer;
  } else if (const auto* given = std::get_if<rigid::Box>(&shape)) {
    rigid::Box longer = *given;
    for (int k = 0; k < 3; ++k) lengthen(longer.half_edges[k], k, pose, periods);
    if (!(longer == *given)) return longer;
  }
  return std::nullopt;
}

}  // namespace silt::coupler

#include "coupler/results/vorticity.hpp"

namespace silt::coupler {

using lbm::Int3;
using rigid::Vec3;

namespace {

/// Derivative of the velocity along an axis.
Vec3 derivative(VelocitiesAround& velocities, Int3 cell, int axis) {
  const auto beside = [&](int steps) {
    Int3 other = cell;
    other[axis] += steps;
    return velocities.at(other);
  };
  const auto before = beside(-1), after = beside(1);
  if (before && after) return 0.5 * (*after - *before);
  if (!before && !after) return Vec3::Zero();
  const int side = after ? 1 : -1;
  const Vec3 u = *beside(0), next = side * ((after ? *after : *before) - u);
  if (const auto second = beside(2 * side)) return 2 * next - 0.5 * side * (*second - u);
  return next;
}

}  // namespace

Vec3 vorticity(VelocitiesAround& velocities, Int3 cell) {
  const Vec3 x = derivative(velocities, cell, 0), y = derivative(velocities, cell, 1),
             z = derivative(velocities, cell, 2);
  return {y[2] - z[1], z[0] - x[2], x[1] - y[0]};
}

}  // namespace silt::coupler

#include "coupler/results/vorticity.hpp"

#include <algorithm>

namespace silt::coupler {

using lbm::Int3;
using rigid::Vec3;

VelocitiesAround::VelocitiesAround(const FluidFields& fields, const CellVelocities& others, int block,
                                   Int3 first, Int3 last)
    : fields_(fields), others_(others), block_(block) {
  const Int3 size = fields.block(block).size;
  for (int d = 0; d < 3; ++d) {
    low_[d] = std::max(first[d] - CellVelocities::reach, 0);
    high_[d] = std::min(last[d] + CellVelocities::reach, size[d]);
  }
  height_.fill(-1);
}

void VelocitiesAround::make(int z) {
  Plane& plane = plane_[z % kept];
  height_[z % kept] = z;
  plane.clear();
  lbm::MomentsByRow moments(fields_, block_, low_.x, high_.x);
  for_cells({low_.x, low_.y, z}, {high_.x, high_.y, z + 1}, [&](Int3 cell) {
    if (!fields_.is_fluid(block_, cell)) return plane.push_back(std::nullopt);
    const auto u = fields_.velocity(moments(cell));
    plane.emplace_back(Vec3(u[0], u[1], u[2]));
  });
}

std::optional<Vec3> VelocitiesAround::at(Int3 cell) {
  for (int d = 0; d < 3; ++d)
    if (cell[d] < low_[d] || cell[d] >= high_[d]) return others_.at(block_, cell);
  if (height_[cell.z % kept] != cell.z) make(cell.z);
  return plane_[cell.z % kept][std::size_t(cell.y - low_.y) * (high_.x - low_.x) + (cell.x - low_.x)];
}

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

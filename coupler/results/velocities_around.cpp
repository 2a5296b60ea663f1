#include "coupler/results/velocities_around.hpp"

#include <algorithm>

#include "coupler/mapping/for_cells.hpp"
#include "lbm/moments.hpp"

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

}  // namespace silt::coupler

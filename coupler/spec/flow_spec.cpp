#include "coupler/spec/flow_spec.hpp"

#include <cmath>

namespace silt::coupler {

rigid::Extent extent_of(const FlowSpec& spec) {
  rigid::Extent extent;
  for (int d = 0; d < 3; ++d) {
    extent.size[d] = spec.cells[d];
    extent.periodic[d] = spec.periodic(d);
  }
  return extent;
}

rigid::BoundingBox box_of(const FlowSpec& spec) {
  return {rigid::Vec3::Zero(), extent_of(spec).size};
}

std::array<lbm::SideCondition, 6> sides_of(const FlowSpec& spec) {
  std::array<lbm::SideCondition, 6> sides;
  for (int k = 0; k < 6; ++k) {
    const BoundarySpec& of = spec.boundary[k];
    sides[k] = {.kind = of.traits().fluid,
                .velocity = {of.velocity[0], of.velocity[1], of.velocity[2]},
                .value = 3 * of.pressure,  // the square of the speed of sound is 1/3
                .varies = of.over_time.varies()};
  }
  return sides;
}

rigid::Vec3 nearest_image(rigid::Vec3 d, const rigid::Extent& extent) {
  for (int axis = 0; axis < 3; ++axis)
    if (extent.periodic[axis]) d[axis] -= extent.size[axis] * std::round(d[axis] / extent.size[axis]);
  return d;
}

int least_margin(const CouplingSpec& coupling) {
  constexpr int own_cell = 1, mapped_ahead = 1;
  return lbm::link_reach(coupling.wall_scheme) + own_cell + mapped_ahead;
}

}  // namespace silt::coupler

#include "coupler/case/case_extent.hpp"

#include <cmath>

#include "coupler/case/case.hpp"

namespace silt::coupler {

rigid::Extent extent_of(const Case& scene) {
  rigid::Extent extent;
  for (int d = 0; d < 3; ++d) {
    extent.size[d] = scene.cells[d];
    extent.periodic[d] = scene.periodic(d);
  }
  return extent;
}

void put_at(BodySpec& body, const rigid::Vec3& point, const rigid::Extent& extent) {
  rigid::Vec3& centre = body.pose.position;
  centre = point - body.pose.orientation * body.origin;
  const auto is_inside = [&](double x, int d) { return x >= 0 && x <= extent.size[d]; };
  for (int d = 0; d < 3; ++d)
    if (extent.periodic[d] && is_inside(point[d], d) && !is_inside(centre[d], d))
      centre[d] -= extent.size[d] * std::floor(centre[d] / extent.size[d]);
}

rigid::Vec3 nearest_image(rigid::Vec3 d, const rigid::Extent& extent) {
  for (int axis = 0; axis < 3; ++axis)
    if (extent.periodic[axis]) d[axis] -= extent.size[axis] * std::round(d[axis] / extent.size[axis]);
  return d;
}

}  // namespace silt::coupler

#include "coupler/place_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coupler/case/case.hpp"
#include "coupler/case/case_check.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

using rigid::Vec3;

namespace {

Vec3 centre_of(lbm::Int3 cell) {
  return {cell.x + 0.5, cell.y + 0.5, cell.z + 0.5};
}

/// From the surface of a row, at its periodic image nearest to the point.
double distance_of(const Scene& scene, std::size_t row, Vec3 point) {
  const rigid::Extent& extent = scene.exchange->extent();
  const rigid::Pose pose = scene.bodies.pose(row);
  if (row < scene.bodies.first_wall())
    for (int d = 0; d < 3; ++d)
      if (extent.periodic[d])
        point[d] -= extent.size[d] * std::round((point[d] - pose.position[d]) / extent.size[d]);
  return rigid::signed_distance(scene.world.shapes[scene.bodies.shape[row]], pose.to_body(point));
}

std::string name_of(const Scene& scene, std::size_t row) {
  return body_name(scene.setup, scene.bodies.id[row]);
}

}  // namespace

Neighbours neighbours_of(const Scene& scene, lbm::Int3 cell, double within) {
  Neighbours near;
  for (std::size_t row = 0; row < scene.bodies.size(); ++row) {
    const Neighbour here{row, distance_of(scene, row, centre_of(cell))};
    if (!(here.distance <= within)) continue;
    if (!near.first || here.distance < near.first->distance)
      near.second = near.first, near.first = here;
    else if (!near.second || here.distance < near.second->distance)
      near.second = here;
  }
  return near;
}

std::string place_text(const Scene& scene, lbm::Int3 cell, const Neighbours& near) {
  std::string text = fmt::format("cell [{}, {}, {}]", cell.x, cell.y, cell.z);
  if (scene.setup.units.si) {
    const Vec3 x = centre_of(cell) * scene.setup.units.scale(dimension::length);
    text += fmt::format(" (at [{}, {}, {}] m)", shown(x[0]), shown(x[1]), shown(x[2]));
  }
  if (near.first)
    text += fmt::format(", {:.1f} cells from {}", std::max(0.0, near.first->distance),
                        name_of(scene, near.first->row));
  if (near.second)
    text += fmt::format(", in a gap of {:.1f} cells to {}",
                        std::max(0.0, near.first->distance + near.second->distance),
                        name_of(scene, near.second->row));
  return text;
}

}  // namespace silt::coupler

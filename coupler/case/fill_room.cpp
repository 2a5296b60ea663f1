#include "coupler/case/fill_room.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "coupler/case/case.hpp"
#include "coupler/case/case_extent.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {
namespace {

[[noreturn]] void refuse(const Case& scene, std::size_t fill, int axis, double radius,
                         const std::string& why) {
  throw CaseError(
      scene.place(fmt::format("fill[{}].box", fill)),
      fmt::format("fill[{}]: bodies of {} cells ({}) do not fit along {}: {}; enlarge it or make the "
                  "bodies smaller",
                  fill, shown(2 * radius), shown(scene.units.physical(2 * radius, dimension::length)),
                  "xyz"[axis], why));
}

}  // namespace

rigid::BoundingBox room_for_centres(const Case& scene, std::size_t index, double radius) {
  const FillSpec& fill = scene.fills[index];
  const rigid::Extent extent = extent_of(scene);
  rigid::BoundingBox room{fill.lower, fill.upper};
  for (int d = 0; d < 3; ++d) {
    double &lower = room.lower[d], &upper = room.upper[d];
    const double length = extent.size[d];
    const bool whole = lower <= 0 && upper >= length;
    if (extent.periodic[d] && 2 * radius + fill.gap > length)
      refuse(scene, index, d, radius, fmt::format("the periodic axis is {} cells long", shown(length)));
    if (extent.periodic[d] && whole) {
      lower = 0;
      upper = length;
      continue;
    }
    lower = extent.periodic[d] ? lower + radius : std::max(lower + radius, radius + fill.gap);
    upper = extent.periodic[d] ? upper - radius : std::min(upper - radius, length - radius - fill.gap);
    if (lower > upper)
      refuse(scene, index, d, radius,
             fmt::format("the box less the gaps to its walls is {} cells wide",
                         shown(std::max(0., upper - lower + 2 * radius))));
  }
  return room;
}

}  // namespace silt::coupler

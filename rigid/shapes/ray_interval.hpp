#pragma once
// Where a straight line is inside a convex shape: one interval, in closed form, exact for lines from afar and
// for grazing ones. (Object mapping asks of vectors of lines from close by: coupler/mapping/line_lanes.hpp.
// Each is tested against the other.)
#include <optional>

#include "rigid/shapes/shape.hpp"

namespace silt::rigid {

struct RayInterval {
  double enter, leave;  // parameters along the line, enter <= leave; may be infinite
};

/// The part of the line origin + t direction inside the shape; none if the line misses it.
std::optional<RayInterval> ray_interval(const ConvexShape&, const Vec3& origin_B, const Vec3& direction_B);

/// The part of the line that is in the hollow of a tube, in closed form; none if it is all in the wall.
std::optional<RayInterval> hollow_interval(const Tube&, const Vec3& origin_B, const Vec3& direction_B);

}  // namespace silt::rigid

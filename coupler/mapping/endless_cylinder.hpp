#pragma once
// A cylinder that reaches its own image beyond a periodic side has no end there, and no edges. What its links
// meet is a longer one (method-walls.md, "Edges").
#include <optional>

#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

/// Returns a cylinder whose axis is a periodic one, longer by twice the period, where it reaches its image
/// there; none of other shapes and elsewhere. periods: cells, 0 along axes that are not periodic.
std::optional<rigid::Shape> endless_cylinder(const rigid::Shape&, const rigid::Pose&,
                                             const rigid::Vec3& periods);

}  // namespace silt::coupler

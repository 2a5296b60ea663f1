#pragma once
// Bodies that reach their own image beyond a periodic side have no end there, and no edges. What their links
// meet is a longer shape (method-walls.md, "Edges").
#include <optional>

#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

/// Returns a cylinder or box with an axis along a periodic one, longer by twice the period, where it reaches
/// its image there; none elsewhere. periods: cells, 0 along axes that are not periodic.
std::optional<rigid::Shape> endless_shape(const rigid::Shape&, const rigid::Pose&,
                                          const rigid::Vec3& periods);

}  // namespace silt::coupler

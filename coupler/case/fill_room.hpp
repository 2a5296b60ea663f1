#pragma once
// Where the bodies of a [[fill]] may be: their bounding spheres, and the room for the centres of those.
#include <cstddef>

#include "rigid/shapes/bounding_box.hpp"
#include "rigid/shapes/shape_fwd.hpp"

namespace silt::coupler {

struct Case;

/// Returns the box of a fill less a radius, and less the gap too where a side of the box is a wall; all of
/// [0, length] along a periodic axis that the box covers. CaseError if not one body fits.
rigid::BoundingBox room_for_centres(const Case&, std::size_t fill, double radius);

}  // namespace silt::coupler

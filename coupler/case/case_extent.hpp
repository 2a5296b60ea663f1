#pragma once
// The domain of a case as the bodies see it.
#include "rigid/bodies/body_exchange.hpp"

namespace silt::coupler {

struct Case;

rigid::Extent extent_of(const Case&);

/// Returns the shortest of the displacements between a point and the periodic images of another.
rigid::Vec3 nearest_image(rigid::Vec3 displacement, const rigid::Extent&);

}  // namespace silt::coupler

#pragma once
// The domain of a case as the bodies see it.
#include "rigid/bodies/body_exchange.hpp"

namespace silt::coupler {

struct BodySpec;
struct Case;

rigid::Extent extent_of(const Case&);

/// Puts a body where the case says it is: its `origin` at a point. Where that is in the domain, the centre of
/// mass is too along the periodic axes, a whole number of periods away.
void put_at(BodySpec&, const rigid::Vec3& point, const rigid::Extent&);

/// Returns the shortest of the displacements between a point and the periodic images of another.
rigid::Vec3 nearest_image(rigid::Vec3 displacement, const rigid::Extent&);

}  // namespace silt::coupler

#pragma once
// Do two bodies overlap? For where bodies are placed: errs to the side of "no", so that no legal scene is
// refused.
#include "rigid/bodies/body_exchange.hpp"
#include "rigid/shapes/shape_fwd.hpp"

namespace silt::coupler {

/// How far a shape reaches into another, at least, in cells; negative if no overlap is found (then, for two
/// spheres, minus their distance). Positive only if they do overlap; exact for a sphere against anything.
double overlap_depth(const rigid::Shape& a, const rigid::Pose& pose_a, const rigid::Shape& b,
                     const rigid::Pose& pose_b);

/// The largest over the periodic images of b.
double overlap_depth(const rigid::Shape& a, const rigid::Pose& pose_a, const rigid::Shape& b,
                     const rigid::Pose& pose_b, const rigid::Extent&);

/// Distance from a point to the nearest periodic image of a shape, negative inside.
double distance_to(const rigid::Shape&, const rigid::Pose&, const rigid::Vec3& x_W, const rigid::Extent&);

}  // namespace silt::coupler

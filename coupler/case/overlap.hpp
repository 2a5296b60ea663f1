#pragma once
// Do two bodies overlap? For scenes before step 1: errs to the side of "no", so that no legal scene is
// refused.
#include <vector>

#include "rigid/bodies/body_exchange.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

/// A ball inside a shape, in the frame of the shape; radius 0: a point of it.
struct InnerBall {
  rigid::Vec3 centre;
  double radius;
};

/// Balls that together stand for a shape: exact for a sphere; a chain of balls for a capsule; for a box the
/// largest ball at its centre and a grid of points on its faces; for a cylinder a chain of balls and points
/// on its ends; for an ellipsoid the largest ball and points on its surface; for a polyhedron a ball, its
/// corners and the middles of its edges and faces; for a compound those of its parts.
std::vector<InnerBall> inner_balls(const rigid::Shape&);

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

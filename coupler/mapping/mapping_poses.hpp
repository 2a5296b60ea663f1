#pragma once
// The poses at which the fluid sees bodies and walls: ahead, at the middle of the way on which a surface
// stays within a tolerance, so that on the mean the fluid sees it where it is (method-coupling.md, "Object
// mapping"). Bodies are mapped in common steps, every 1, 3, 9, ... of them.
#include <cstdint>

#include "coupler/spec/coupling_spec.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/walls.hpp"
#include "rigid/bodies/world.hpp"

namespace silt::coupler {

/// Gives bodies a new mapped motion at the first steps of intervals of 3^k steps, the longest on which they
/// stay within the tolerance (cells, of any point of the surface); in between, if they are further than a
/// sixth of it from where they were foreseen. Where distances do not follow, 0.15 of it is the tolerance.
/// `step`: how many were done. Only the state decides: every holder of a body does the same.
void renew_mapping_poses(rigid::BodySet&, const rigid::World&, const CouplingSpec&, std::int64_t step);

/// When and where a wall that moves is mapped: a function of the step alone, as its pose is.
class WallMapping {
 public:
  /// Keeps a reference to the wall. tolerance: CouplingSpec::remap_tolerance; distances do not follow.
  WallMapping(const rigid::MeshWallSpec&, double tolerance);
  /// Returns the pose at which the fluid sees the wall in a step.
  rigid::Pose pose(std::int64_t step) const;

 private:
  const rigid::MeshWallSpec& wall_;
  std::int64_t steps_ = 1;  // from one mapping to the next
};

}  // namespace silt::coupler

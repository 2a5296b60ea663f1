#pragma once
// The poses at which the fluid sees bodies and walls. Mapping a surface costs as much however little it has
// moved, so one that goes on as it does is mapped ahead, at the middle of the way on which it stays within a
// tolerance: on the mean the fluid sees it where it is. Where cells change sides, links of the bodies around
// are built anew as well: so bodies are mapped in common steps, every 1, 2, 4, ... of them.
#include <cstdint>

#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/walls.hpp"
#include "rigid/bodies/world.hpp"

namespace silt::coupler {

/// Gives bodies a new mapping pose at the first steps of intervals of 2^k steps, the longest on which they
/// stay within `tolerance` (cells, of any point of the surface); in between, if they are a tenth further than
/// that from where they are mapped. `step`: how many were done. Only the state decides: every holder of a
/// body does the same.
void renew_mapping_poses(rigid::BodySet&, const rigid::World&, double tolerance, std::int64_t step);

/// When and where a wall that moves is mapped: a function of the step alone, as its pose is.
class WallMapping {
 public:
  /// Keeps a reference to the wall. tolerance: in cells, of any point of the surface.
  WallMapping(const rigid::MeshWallSpec&, double tolerance);
  /// Where the fluid sees the wall in a step.
  rigid::Pose pose(std::int64_t step) const;

 private:
  const rigid::MeshWallSpec& wall_;
  std::int64_t steps_ = 1;  // from one mapping to the next
};

}  // namespace silt::coupler

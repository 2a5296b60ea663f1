#pragma once
// The poses at which the fluid sees bodies and walls. Mapping a surface costs as much however little it has
// moved, so one that goes on as it does is mapped ahead, at the middle of the way on which it stays within a
// tolerance: on the mean the fluid sees it where it is.
#include <cstdint>

#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/walls.hpp"
#include "rigid/bodies/world.hpp"

namespace silt::coupler {

/// Gives bodies that are further than `tolerance` (cells, of any point of the surface) from where they are
/// mapped a new mapping pose. Only the state decides: every holder of a body does the same.
void renew_mapping_poses(rigid::BodySet&, const rigid::World&, double tolerance);

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

#pragma once
// The poses at which the fluid sees bodies and walls. A surface is mapped ahead of its motion, at the middle
// of the path on which it stays within a tolerance, so that its mean position is right (method-coupling.md,
// "Object mapping"). Bodies are mapped at common steps: all, every 3rd, every 9th, ...
#include <cstdint>

#include "coupler/spec/flow_spec.hpp"
#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/walls.hpp"
#include "rigid/bodies/world.hpp"

namespace silt::coupler {

/// Gives bodies new mapping poses at the first step of intervals of 3^k steps. The interval is the longest in
/// which no point of the surface moves further than the tolerance (cells); a body that is off its predicted
/// pose by more than a sixth of the tolerance is mapped earlier. Where distances are not updated between
/// mappings, 0.15 of the tolerance applies. A body that crosses a periodic side keeps the pose before it.
/// `step` is the number of steps done. All holders of a body get the same result, which depends on its state
/// alone.
void renew_mapping_poses(rigid::BodySet&, const rigid::World&, const rigid::Extent&, const CouplingSpec&,
                         std::int64_t step);

/// Times and poses at which a moving wall is mapped, a function of the step alone like its pose.
class WallMapping {
 public:
  /// Refers to the wall. `tolerance` is CouplingSpec::remap_tolerance; distances are not updated in between.
  WallMapping(const rigid::MeshWallSpec&, double tolerance);
  /// Returns the pose at which the fluid sees the wall in a step.
  rigid::Pose pose(std::int64_t step) const;

 private:
  const rigid::MeshWallSpec& wall_;
  std::int64_t steps_ = 1;  // from one mapping to the next
};

}  // namespace silt::coupler

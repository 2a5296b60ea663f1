#pragma once
#include "rigid/bodies/body_set.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

/// A spring and a damper between two points, each fixed to a body, or the second to the domain.
struct SpringSpec {
  rigid::BodyId body = 0, to = 0;  // 0: the domain
  rigid::Vec3 arm = rigid::Vec3::Zero(),
              to_arm = rigid::Vec3::Zero();  // from the centre of mass, in its frame
  double stiffness = 0, damping = 0;
  double length = 0;          // at which it does not pull; 0: the two points are one
  double compliance[2] = {};  // of the two points: velocity by an impulse, at most
};

}  // namespace silt::coupler

#pragma once
#include "rigid/bodies/body_set.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

/// A spring and a damper between two points, each fixed to a body; the second may be fixed to the domain.
struct SpringSpec {
  rigid::BodyId body = 0, to = 0;  // 0: the domain
  rigid::Vec3 arm = rigid::Vec3::Zero(),
              to_arm = rigid::Vec3::Zero();  // from the centre of mass, in its frame
  double stiffness = 0, damping = 0;
  double length = 0;          // at rest; 0: holds the points together
  double compliance[2] = {};  // of each point: largest velocity per impulse
};

}  // namespace silt::coupler

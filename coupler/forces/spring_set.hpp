#pragma once
// Solves for the forces of springs and dampers with common bodies (method.md, equations 49 to 50b).
#include <array>
#include <span>
#include <vector>

#include "rigid/math/types.hpp"

namespace silt::coupler {

/// The mobility of a body: square roots of its inverse mass along each axis and of its inverse inertia (W).
/// Zero for a fixed body, and along or about locked axes.
struct Yield {
  rigid::Vec3 along = rigid::Vec3::Zero();
  rigid::Mat3 about = rigid::Mat3::Zero();
};

/// A spring in the middle of a step.
struct SpringInStep {
  std::array<int, 2> bodies;        // indices in the set; -1: the domain
  std::array<rigid::Vec3, 2> arms;  // from the centres of mass, W
  rigid::Vec3 force;                // of the spring on its first end, reversed on the second
  rigid::Vec3 rate, gain;  // velocity of the second end relative to the first at the start of the step, and
                           // its change in the step by other forces than the set's
  rigid::Mat3 damping;     // positive semidefinite
};

/// Returns the force of each spring and damper on its first end.
std::vector<rigid::Vec3> forces_of(std::span<const SpringInStep>, std::span<const Yield> bodies);

}  // namespace silt::coupler

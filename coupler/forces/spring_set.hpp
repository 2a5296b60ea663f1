#pragma once
// The forces of springs and dampers that share bodies, solved together (method.md, equations 49 to 50b).
#include <array>
#include <span>
#include <vector>

#include "rigid/math/types.hpp"

namespace silt::coupler {

/// How a body yields: roots of its inverse mass along each axis and of its inverse inertia (W). Zero where it
/// does not, because it is fixed or about and along locked axes.
struct Yield {
  rigid::Vec3 along = rigid::Vec3::Zero();
  rigid::Mat3 about = rigid::Mat3::Zero();
};

/// A spring in the middle of a step.
struct SpringInStep {
  std::array<int, 2> bodies;        // indices into the set's; -1: the domain
  std::array<rigid::Vec3, 2> arms;  // from the centres of mass, W
  rigid::Vec3 force;                // of the spring on its first end, and against it on its second one
  rigid::Vec3 rate, gain;  // of the second end seen from the first one: the velocity at the beginning
                           // of the step, and what else than the set changes it by in the step
  rigid::Mat3 damping;     // positive semidefinite
};

/// Returns the force of each spring with its damper on its first end.
std::vector<rigid::Vec3> forces_of(std::span<const SpringInStep>, std::span<const Yield> bodies);

}  // namespace silt::coupler

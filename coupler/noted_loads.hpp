#pragma once
// What acted on each body in the last step, noted with the body for output: it stays with it if another rank
// becomes its owner. Lattice units, world frame, torques about the centre of mass.
#include <vector>

#include "rigid/bodies/body_set.hpp"

namespace silt::coupler {

struct BodyLoad {
  rigid::Vec3 force = rigid::Vec3::Zero(), torque = rigid::Vec3::Zero();
};

/// Notes what acts on the owned bodies now, gravity apart.
void note_loads(rigid::BodySet&);
/// Adds what the contacts of an owned body did in a sub-step of the step, which has length 1.
void note_contact_impulse(rigid::BodySet&, std::size_t row, const rigid::Vec3& impulse,
                          const rigid::Vec3& angular_impulse);
/// Begins a step in which no contact has acted yet.
void forget_contact_loads(rigid::BodySet&);

/// Returns what was noted of the owned bodies, by row.
std::vector<BodyLoad> noted_loads(const rigid::BodySet&);
std::vector<BodyLoad> noted_contact_loads(const rigid::BodySet&);

}  // namespace silt::coupler

#pragma once
// The torque of contacts on tubes and meshes. Where a body touches a wall is known only while its contacts
// are.
#include <span>
#include <vector>

#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/contact.hpp"
#include "rigid/response/contact_resolver.hpp"

namespace silt::coupler {

struct ContactTorque {
  int wall;            // of [[walls]]
  rigid::Vec3 torque;  // of one contact's impulse, lattice units, about the point of the wall
};

/// What a contact did to a wall in a sub-step besides the impulse that its body remembers.
struct WallImpulse {
  rigid::BodyId wall;
  rigid::Vec3 impulse, torque;  // the latter about the point of the wall
};

/// What the contacts of owned bodies did to [[walls]] in a sub-step whose velocities are final, and whose
/// second half of the drift is still to come.
std::vector<ContactTorque> contact_torques(const rigid::BodySet&, std::span<const rigid::Contact>,
                                           const rigid::Extent&);

/// Appends what they did besides, at the same time.
void add_wall_impulses(const rigid::BodySet&, std::span<const rigid::OtherWallImpulse>, const rigid::Extent&,
                       std::vector<WallImpulse>&);

}  // namespace silt::coupler

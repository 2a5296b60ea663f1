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
  rigid::Vec3 torque;  // of one contact's or film's impulse, lattice units, about the point of the wall
};

/// What contacts and films of owned bodies did to [[walls]] in a sub-step whose velocities are final, and
/// whose second half of the drift is still to come.
std::vector<ContactTorque> contact_torques(const rigid::BodySet&, std::span<const rigid::Contact>,
                                           std::span<const rigid::FilmOnWall>, const rigid::Extent&);

}  // namespace silt::coupler

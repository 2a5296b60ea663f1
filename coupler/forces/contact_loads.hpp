#pragma once
// The loads of contacts on what they cannot move: sides, tubes and meshes, and bodies that are fixed or of
// prescribed motion; and what contacts add to the stress. The point of a contact is known only while the
// contact exists.
#include <array>
#include <span>
#include <vector>

#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/contact.hpp"
#include "rigid/response/contact_resolver.hpp"

namespace silt::coupler {

/// The impulse of a contact in a sub-step.
struct ContactLoad {
  rigid::BodyId on;
  int kind;                     // of a body; of a wall it means nothing
  rigid::Vec3 impulse, torque;  // lattice units, the latter about the point of the wall or the body's centre
};

/// The impulses of an owned body's contacts in a sub-step times the ways to them from its centre: what they
/// add to the stress.
struct ContactMoment {
  int kind;
  rigid::Vec3 position;
  std::array<double, 6> moment;  // xx yy zz xy xz yz
};

/// The symmetric part of a tensor product.
inline std::array<double, 6> symmetric_product(const rigid::Vec3& a, const rigid::Vec3& b) {
  return {a[0] * b[0],
          a[1] * b[1],
          a[2] * b[2],
          0.5 * (a[0] * b[1] + a[1] * b[0]),
          0.5 * (a[0] * b[2] + a[2] * b[0]),
          0.5 * (a[1] * b[2] + a[2] * b[1])};
}

/// The contacts of a sub-step whose velocities are final and whose second half of the drift is still to come.
struct ContactsInStep {
  const rigid::BodySet& bodies;
  std::span<const rigid::Contact> contacts;    // sorted by key
  std::span<const rigid::OtherImpulse> other;  // than what bodies remember
};

/// Appends the loads that contacts of owned free bodies put on walls and on bodies of infinite mass.
void add_contact_loads(const ContactsInStep&, const rigid::Extent&, std::vector<ContactLoad>&);

/// Appends the moments of the owned free bodies' contacts, and where these are in the domain, which a body
/// may have left by a period in the first half of the drift.
void add_contact_moments(const ContactsInStep&, const rigid::Extent&, std::vector<ContactMoment>&);

}  // namespace silt::coupler

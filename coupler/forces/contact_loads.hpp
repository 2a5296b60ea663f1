#pragma once
// Contact loads on walls and on bodies of infinite mass, and the contribution of contacts to the stress. They
// are evaluated in the step, since the contact points are not stored.
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
  int kind;                     // of a body; undefined for a wall
  rigid::Vec3 impulse, torque;  // lattice units; torque about the wall's reference point or the body's centre
};

/// The sum over an owned body's contacts of impulse times arm in a sub-step: their part of the stress.
struct ContactMoment {
  int kind;
  rigid::Vec3 position;
  std::array<double, 6> moment;  // xx yy zz xy xz yz
};

/// Returns the symmetric part of a tensor product.
inline std::array<double, 6> symmetric_product(const rigid::Vec3& a, const rigid::Vec3& b) {
  return {a[0] * b[0],
          a[1] * b[1],
          a[2] * b[2],
          0.5 * (a[0] * b[1] + a[1] * b[0]),
          0.5 * (a[0] * b[2] + a[2] * b[0]),
          0.5 * (a[1] * b[2] + a[2] * b[1])};
}

/// The contacts of a sub-step, after the velocities are final and before the second half of the drift.
struct ContactsInStep {
  const rigid::BodySet& bodies;
  std::span<const rigid::Contact> contacts;    // sorted by key
  std::span<const rigid::OtherImpulse> other;  // impulses that bodies do not store
};

/// Appends the loads of contacts of owned free bodies on walls and on bodies of infinite mass.
void add_contact_loads(const ContactsInStep&, const rigid::Extent&, std::vector<ContactLoad>&);

/// Appends the moments of the owned free bodies' contacts, at the bodies' canonical positions (the first half
/// of the drift may have moved a body by a period).
void add_contact_moments(const ContactsInStep&, const rigid::Extent&, std::vector<ContactMoment>&);

}  // namespace silt::coupler

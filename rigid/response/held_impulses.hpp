#pragma once
// What contacts give a body that is held at rest (rigid/README.md, What sleeps): impulses of partners that
// do not move either are held, step after step, in BodySet::rest; those of partners that move are its load.
#include <span>

#include "rigid/response/contact_resolver.hpp"
#include "rigid/response/pair_lanes.hpp"

namespace silt::rigid {

/// Before a step: if the row is an owned body at rest, what it remembers of the pair is held from now on
/// (hold), or no longer.
void hold_or_release(BodySet&, std::size_t row, std::span<const Contact> of_pair, bool hold);

/// After it, before those of this step are remembered. `in_contact`: rows whose contacts were looked at;
/// bodies at rest among them keep what is held, the others all they have.
void forget_last_impulses(BodySet&, std::span<const std::size_t> in_contact);

/// Adds a pair's impulses to the loads of those of its bodies that are at rest.
void add_load(const BodySet&, std::size_t row_a, std::size_t row_b, std::span<const Contact> of_pair,
              std::span<const ContactImpulse>, StepVelocities&);

}  // namespace silt::rigid

#pragma once
// Forces with which surfaces pull each other together (method.md, K1 and K2). A pull acts along the
// normal of a contact, whose own impulse presses against it: what is left of that while others pull the
// bodies apart holds them, and where nothing is left they part.
#include <cmath>
#include <span>

#include "rigid/bodies/contact.hpp"
#include "rigid/bodies/world.hpp"
#include "rigid/response/warm_start.hpp"

namespace silt::rigid {

/// The reduced radius of the surfaces at a contact, from the distances of its bodies' centres along the
/// normal.
inline double reduced_radius(const Contact& c) {
  const double a = std::abs(c.normal.dot(c.r_a));
  if (is_wall(c.b)) return a;
  const double b = std::abs(c.normal.dot(c.r_b));
  return a * b / (a + b);
}

/// Sets the pull of each contact of a pair, a share each of the pair's. One that pressed in the step before
/// has an impulse already, and is a contact as long as it has opened by no more than a hair.
void set_pulls(const Material&, double dt, std::span<const Contact> of_pair, std::span<ContactImpulse>);

/// The most that set_pulls may give them: for what they recall of the step before.
void set_greatest_pulls(const Material&, double dt, std::span<const Contact> of_pair,
                        std::span<ContactImpulse>);

}  // namespace silt::rigid

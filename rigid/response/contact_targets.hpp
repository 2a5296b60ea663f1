#pragma once
// The least normal velocity that a contact is to have after a step (method.md, C1), and in the position
// correction (C7).
#include <algorithm>
#include <cmath>
#include <span>

#include "rigid/bodies/contact.hpp"
#include "rigid/bodies/world.hpp"
#include "rigid/response/contact_resolver.hpp"
#include "rigid/response/warm_start.hpp"

namespace silt::rigid {

inline double lever_arms(const Contact& c) {
  return is_wall(c.b) ? c.r_a.norm() : c.r_a.norm() + c.r_b.norm();
}

/// The target closes the gap, or is the one that Newton's restitution asks of a contact that would be
/// reached, by the velocities before the kick (so that a body at rest does not bounce), as far as a
/// lubrication film leaves them.
struct Target {
  double velocity;
  double impact_change = 0;  // of the velocity, where the contact is hit
};
inline Target target_of(const Contact& c, double dt, double reduced_mass, const Vec3& before) {
  const double closing = c.gap > 0 ? -c.gap / dt : 0.0;
  const double speed = c.normal.dot(before) / (1 + dt * c.lubrication.normal / reduced_mass);
  const bool hits = speed < 0 && (c.gap <= 0 || c.gap + dt * speed < 0);
  if (!hits) return {closing};
  const double target = std::max(closing, -c.restitution * speed);
  return {target, target - speed};
}

/// A contact that pressed may have opened by this share of the lever arms.
inline constexpr double hair = 1e-4;

/// The target of a contact that pressed in the last step: one that has opened by a hair is held, not let
/// fall. Else the load shifts to the contacts that are left and back again, and stacks rock and creep. A
/// lubrication film holds by itself, and its impulse does not mean that the surfaces touched.
inline double target_of_pressed(const Contact& c, double dt, double target) {
  return c.gap > 0 && !c.lubrication ? std::max(target, std::min(0.0, hair * lever_arms(c) - c.gap) / dt)
                                     : target;
}

/// An overlap that a correction is worth.
inline bool is_correctable(const Contact& c, const ResolverSettings& settings) {
  constexpr double negligible = 1e-9;  // relative to the lever arms
  return settings.correction > 0 && -c.gap > settings.slop &&
         -c.gap > settings.slop + negligible * lever_arms(c);
}

/// The share of the overlap that the normal velocity does not take back by itself; an open contact may use up
/// the gap that is left.
inline double target_of_push(const Contact& c, double dt, double velocity, const ResolverSettings& settings) {
  if (c.gap > 0) return std::min(0.0, -(c.gap / dt + velocity));
  const double overlap = settings.correction * (-c.gap - settings.slop) / dt - std::max(0.0, velocity);
  return is_correctable(c, settings) ? std::max(0.0, overlap) : 0;
}

// Forces pull surfaces together (method.md, K1 and K2). A pull acts along the normal of a contact, whose
// own impulse presses against it: what is left of that impulse while others pull the bodies apart holds them,
// and where nothing is left they part.

/// The contacts of two bodies that attract each other, and their velocities.
struct CohesivePair {
  const Material& material;
  double dt;
  std::span<const Contact> contacts;
  bool joined;  // as Turning has it
  Twist a, b;
};

/// Sets the pull of each contact of a pair, a share each of the pair's, and the gap that it is to keep, by
/// the velocities before the kick. One that pressed in the step before has an impulse already, and is a
/// contact as long as it has opened by no more than a hair and by what turning does.
void set_pulls(const CohesivePair&, std::span<ContactImpulse>);

/// The most that set_pulls may give them: for what they recall of the step before.
void set_greatest_pulls(const CohesivePair&, std::span<ContactImpulse>);

/// Returns the velocity, of b seen from a, that leaves a pair as it is while it turns, at the velocities at
/// hand (K3, K4), and sets the targets, as velocities besides that one. Zero where nothing pulls or turns.
Vec3 keep_together(const CohesivePair&, std::span<const ContactImpulse>, std::span<double> targets);

}  // namespace silt::rigid

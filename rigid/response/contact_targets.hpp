#pragma once
// The least normal velocity that a contact is to have after a step (method.md, C1), and in the position
// correction (C7).
#include <algorithm>

#include "rigid/response/contact_resolver.hpp"

namespace silt::rigid {

inline double lever_arms(const Contact& c) {
  return is_wall(c.b) ? c.r_a.norm() : c.r_a.norm() + c.r_b.norm();
}

/// What closes the gap, or what Newton's restitution asks of a contact that would be reached, from the
/// velocities before the kick (so that a body at rest does not bounce) and what a lubrication film leaves of
/// them.
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

/// By so much of the lever arms a contact that pressed may have opened.
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

}  // namespace silt::rigid

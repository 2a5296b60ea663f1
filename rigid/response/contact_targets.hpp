#pragma once
// The target of a contact: its least normal velocity after a step (method.md, C1), or in the correction (C7).
#include <algorithm>
#include <span>

#include "rigid/bodies/contact.hpp"
#include "rigid/bodies/world.hpp"
#include "rigid/response/contact_resolver.hpp"
#include "rigid/response/warm_start.hpp"

namespace silt::rigid {

/// Relative rotation of two bodies that stay in contact: a contact in the middle of a step of length dt, with
/// its bodies' velocities. Between the middles of two steps bodies drift along straight lines, so that
/// rolling surfaces separate, and bodies that rotate together slide apart, by an amount of second order in
/// the angle, which cohesion has to correct (method.md, K3 and K4).
class Turning {
 public:
  /// `joined`: both arms end at one point (method.md, C3a).
  Turning(const Contact&, bool joined, const Twist& a, const Twist& b, double dt);

  /// Returns the gap at the start of the step.
  double gap_at_start() const;
  /// Returns the gap in the middle of the step of surfaces that touch at its start and end.
  double gap_of_chord() const;
  /// Returns the normal in the middle of the last step.
  Vec3 normal_before() const;
  /// Returns the velocity of b relative to a, at the contact, that keeps b at its place relative to a until
  /// the middle of the next step. Its normal component does not depend on the current normal velocity.
  Vec3 velocity_together() const;

 private:
  Vec3 velocity_along(const Quat& turned, double time) const;

  Vec3 normal_, between_,
      across_;      // vector between the centres, from a to b; its rate without that of the gap
  Vec3 turn_;       // angular velocity of the normal; not used with centres
  Quat half_turn_;  // rotation by it in half a step
  double gap_, opening_rate_, dt_;
  bool with_centres_;
};

inline double lever_arms(const Contact& c) {
  return is_wall(c.b) ? c.r_a.norm() : c.r_a.norm() + c.r_b.norm();
}

/// The velocity that closes the gap or, for a contact that would be reached, that of Newton's restitution.
/// The approach velocity is that before the kick (so that a body at rest does not bounce). A film reduces it
/// by the impulse over the gap, and reduces the rebound by the impulse between the contact and the end of the
/// step (L4).
struct Target {
  double velocity;
  double impact_change = 0;  // change of velocity by the impact, if any
};
inline Target target_of(const Contact& c, double dt, double reduced_mass, const Vec3& before) {
  const double gap = std::max(c.gap, 0.0), closing = gap > 0 ? -gap / dt : 0.0;
  const double approach = c.normal.dot(before);
  if (!(approach < 0 && (gap == 0 || gap + dt * approach < 0))) return {closing};
  const double speed = approach + gap * c.lubrication.normal / reduced_mass;
  if (speed >= 0) return {closing};  // the film stops it before
  const double rebound = -c.restitution * speed, film = c.lubrication.leaving / reduced_mass;
  return {std::max(0.0, rebound - gap * film) / (1 + dt * film), rebound - speed};
}

/// Largest opening of a contact that still counts as pressed, relative to the lever arms.
inline constexpr double hair = 1e-4;

/// The target of a contact that pressed in the last step. A contact that has opened by less than `hair`
/// counts as closed: otherwise the load would shift to the other contacts and back, and stacks would rock and
/// creep. With a lubrication film this is not necessary, and its impulse does not mean that the surfaces
/// touched.
inline double target_of_pressed(const Contact& c, double dt, double target) {
  return c.gap > 0 && !c.lubrication ? std::max(target, std::min(0.0, hair * lever_arms(c) - c.gap) / dt)
                                     : target;
}

/// Returns whether an overlap is large enough for a correction.
inline bool is_correctable(const Contact& c, const ResolverSettings& settings) {
  constexpr double negligible = 1e-9;  // relative to the lever arms
  return settings.correction > 0 && -c.gap > settings.slop &&
         -c.gap > settings.slop + negligible * lever_arms(c);
}

/// The correction of the overlap beyond what the normal velocity removes; open contacts may use up the gap.
inline double target_of_push(const Contact& c, double dt, double velocity, const ResolverSettings& settings) {
  if (c.gap > 0) return std::min(0.0, -(c.gap / dt + velocity));
  const double overlap = settings.correction * (-c.gap - settings.slop) / dt - std::max(0.0, velocity);
  return is_correctable(c, settings) ? std::max(0.0, overlap) : 0;
}

// Cohesion (method.md, K1 and K2). The pull acts along the normal of a contact, whose own impulse acts
// against it. Surfaces part once nothing of that impulse is left.

/// The contacts of two cohesive bodies, and their velocities.
struct CohesivePair {
  const Material& material;
  double dt;
  std::span<const Contact> contacts;
  bool joined;  // see Turning
  Twist a, b;
};

/// Sets for each contact its share of the pair's pull and the gap to be kept, from the velocities before the
/// kick. A contact that pressed in the last step has an impulse; it persists while it has opened by no more
/// than a hair plus the opening by rotation.
void set_pulls(const CohesivePair&, std::span<ContactImpulse>);

/// Sets the largest pulls possible, to limit the impulses recalled from the last step.
void set_greatest_pulls(const CohesivePair&, std::span<ContactImpulse>);

/// Returns the relative velocity of b at which the pair keeps its gap while it rotates (K3, K4), and makes
/// the targets relative to it. Zero without pull or rotation.
Vec3 keep_together(const CohesivePair&, std::span<const ContactImpulse>, std::span<double> targets);

}  // namespace silt::rigid

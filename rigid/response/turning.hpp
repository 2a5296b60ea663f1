#pragma once
// Relative rotation of two bodies that stay in contact. Between the middles of two steps bodies drift along
// straight lines, so that rolling surfaces separate, and bodies that rotate together slide apart, by an
// amount of second order in the angle, which cohesion has to correct (method.md, K3 and K4).
#include "rigid/bodies/contact.hpp"

namespace silt::rigid {

/// A contact in the middle of a step of length dt, with its bodies' velocities.
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

}  // namespace silt::rigid

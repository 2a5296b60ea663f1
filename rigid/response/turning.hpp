#pragma once
// How two bodies that stay in contact turn about each other. Between the middles of two steps they drift
// along straight lines, so that surfaces which move along each other part, and bodies that turn as one slide
// apart, by an amount of the second order of the angle; what coheres has to make up for it (method.md, K3 and
// K4).
#include "rigid/bodies/contact.hpp"

namespace silt::rigid {

/// A contact in the middle of a step of length dt, whose bodies move by these velocities.
class Turning {
 public:
  /// `joined`: both arms reach to one point (method.md, C3a).
  Turning(const Contact&, bool joined, const Twist& a, const Twist& b, double dt);

  /// Returns the gap at the beginning of the step.
  double gap_at_start() const;
  /// Returns the gap now of surfaces that touch at both ends of the step.
  double gap_of_chord() const;
  /// Returns the normal in the middle of the step before.
  Vec3 normal_before() const;
  /// Returns the velocity at the contact, of b seen from a, that leaves b where it is, seen from a, in the
  /// middle of the next step. Its normal part does not depend on the normal velocity at hand.
  Vec3 velocity_together() const;

 private:
  Vec3 velocity_along(const Quat& turned, double time) const;

  Vec3 normal_, between_, across_;  // centres from a to b; their velocity, but for that of the gap
  Vec3 turn_;                       // of the normal; but with centres
  Quat half_turn_;                  // by it, in half a step
  double gap_, opening_rate_, dt_;
  bool with_centres_;
};

}  // namespace silt::rigid

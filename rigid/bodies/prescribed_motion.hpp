#pragma once
// The prescribed motion of a wall or a body: a function of time alone, so a run that goes on, or runs on
// other ranks, has bitwise the same walls.
#include <vector>

#include "rigid/math/types.hpp"

namespace silt::rigid {

/// The share of something that acts at a time: straight lines between the rows of a table, and an oscillation
/// that is added to them. A function of time alone.
struct OverTime {
  struct Row {
    double time, share;
  };
  std::vector<Row> table = {};  // times grow; constant before and after it; without rows the share is 1
  double amplitude = 0, frequency = 0;  // 1 / step

  bool varies() const { return !table.empty() || amplitude != 0; }
  double at(double time) const;
  /// Returns what the size of the share never exceeds.
  double most() const;
};

/// A row of a table of motion: where the wall has gone to since time 0.
struct MotionRow {
  double time;
  Vec3 displacement, rotation;  // rotation: vector along the axis, its length the angle in radian
};

/// The wall's reference point is carried along and the wall turns about it; what is given of all this is
/// added up, but a turn at a constant rate and one of a table exclude each other. Lattice units.
struct PrescribedMotion {
  Vec3 velocity = Vec3::Zero(), angular_velocity = Vec3::Zero();
  Vec3 amplitude = Vec3::Zero();      // the reference point oscillates about where it would be without
  double frequency = 0;               // 1 / step
  std::vector<MotionRow> table = {};  // times grow; before and after it the wall rests

  bool moves() const;
  /// Returns the pose of a wall that was at `start` at time 0, but for the displacement that the
  /// table gives it then.
  Pose pose(const Pose& start, double time) const;
  struct Velocity {
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  };
  /// The derivative of the pose.
  Velocity velocity_at(double time) const;
  /// The constant velocities that lead from the pose at a time to that a step later.
  Velocity over_step(double time) const;
  /// No point of the wall within `radius` of the reference point is ever faster.
  double speed_bound(double radius) const;
};

}  // namespace silt::rigid

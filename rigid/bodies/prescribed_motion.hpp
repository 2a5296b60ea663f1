#pragma once
// The prescribed motion of a wall or a body, a function of time only: restarts and ranks do not change it.
#include <vector>

#include "rigid/math/types.hpp"

namespace silt::rigid {

/// A factor as a function of time: linear interpolation in a table, plus an oscillation.
struct OverTime {
  struct Row {
    double time, share;
  };
  std::vector<Row> table = {};  // sorted by time; constant beyond its ends; without rows the share is 1
  double amplitude = 0, frequency = 0;  // 1 / step

  bool varies() const { return !table.empty() || amplitude != 0; }
  double at(double time) const;
  /// Returns an upper bound of |share|.
  double most() const;
};

/// A row of a table of motion: the displacement and rotation since time 0.
struct MotionRow {
  double time;
  Vec3 displacement, rotation;  // rotation vector, in radians
};

/// Motion of a wall's reference point and rotation about it. The given motions are added; a constant angular
/// velocity and a table's rotation exclude each other. Lattice units.
struct PrescribedMotion {
  Vec3 velocity = Vec3::Zero(), angular_velocity = Vec3::Zero();
  Vec3 amplitude = Vec3::Zero();      // of an oscillation of the reference point
  double frequency = 0;               // 1 / step
  std::vector<MotionRow> table = {};  // sorted by time; the wall rests before and after

  bool moves() const;
  /// Returns the pose at `time` of a wall that starts at `start` plus the table's displacement at time 0.
  Pose pose(const Pose& start, double time) const;
  struct Velocity {
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  };
  /// Returns the derivative of the pose.
  Velocity velocity_at(double time) const;
  /// Returns the constant velocities that lead from the pose at `time` to that one step later.
  Velocity over_step(double time) const;
  /// Returns an upper bound of the speed of all points within `radius` of the reference point.
  double speed_bound(double radius) const;
};

}  // namespace silt::rigid

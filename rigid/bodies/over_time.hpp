#pragma once
// A given velocity or acceleration is multiplied with this as time goes on.
#include <vector>

namespace silt::rigid {

/// The share of something that acts at a time: straight lines between the rows of a table, and an oscillation
/// that is added to them. A function of time alone, as the motion of a wall.
struct OverTime {
  struct Row {
    double time, share;
  };
  std::vector<Row> table = {};  // times grow; constant before and after it; without rows the share is 1
  double amplitude = 0, frequency = 0, phase = 0;  // 1 / step; radian at time 0

  bool varies() const { return !table.empty() || amplitude != 0; }
  double at(double time) const;
  /// Returns the integral from time 0 on: the time itself where nothing varies.
  double integral(double time) const;
  /// Returns what the size of the share never exceeds.
  double most() const;
};

}  // namespace silt::rigid

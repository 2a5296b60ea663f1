#pragma once
// How far bodies may move in a step, and how deep they may overlap.
#include <vector>

namespace silt::coupler {

struct Case;

/// Bodies that move further in a step (cells) cover cells that no neighbour has seen. Only with a fluid.
inline constexpr double furthest_motion = 1;

/// The limits of a case, in cells a step, by the shape of a body. With a fluid furthest_motion. Without, in a
/// sub-step half of contacts.margin and half of the body's least width (of its thinnest part): then of two
/// bodies that were out of each other's reach before a sub-step none has passed the middle of the other after
/// it, nor the surface of a wall by its own middle, so that their contact pushes them back where they came
/// from.
class MotionLimits {
 public:
  explicit MotionLimits(const Case&);
  double of(int shape) const { return of_shape_[shape]; }
  double least() const { return least_; }
  /// Half of the least width of the thinnest part, in cells: what overlaps deeper than that is pushed out on
  /// the other side. Infinite for meshes.
  double half_width(int shape) const { return half_width_[shape]; }
  double least_half_width() const { return least_half_width_; }

 private:
  std::vector<double> of_shape_, half_width_;
  double least_, least_half_width_;
};

}  // namespace silt::coupler

#pragma once
// Finds when a flow has become steady, by a quantity that is looked at every so many steps.
//
// Three values in a row, v0, v1, v2, and the ratio r = |v2 - v1| / |v1 - v0| of their changes tell how much
// an approach that dies away geometrically still has before it: |v2 - v1| r / (1 - r). The flow is steady
// when this, or the last change itself if that is more, is at most `change` times |v2| at two looks in a row:
// a small change alone proves nothing, for a slow approach changes little from look to look, and one that
// swings stands still where it turns. A ratio above `highest_ratio` cannot be told from rounding and is taken
// for that: a flow that needs more than 1 / (1 - highest_ratio) looks to fade wants looks further apart; a
// swing of ten, closer.
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace silt {

class SteadyWatch {
 public:
  static constexpr double highest_ratio = 0.99;

  /// The memory of a watch from look to look.
  struct State {
    std::int64_t looks = 0;             // with a value that is a number
    double value = 0, last_change = 0;  // of the latest look; of the one before it to that
    std::int64_t within = 0;            // looks in a row that found it steady
  };

  /// Watches until at most the share `change` of the value is left.
  explicit SteadyWatch(double change) : change_(change) {}

  /// Takes the value of a look; one that is not a number makes the watch begin again.
  void look(double value) {
    if (!std::isfinite(value)) {
      state_ = State{};
      return;
    }
    const double change = value - state_.value;
    const bool settled = remaining(state_.last_change, change) <= change_ * std::abs(value);
    if (state_.looks >= 2) state_.within = settled ? state_.within + 1 : 0;
    state_.last_change = change;
    state_.value = value;
    ++state_.looks;
  }
  bool steady() const { return state_.within >= 2; }
  /// Returns the estimated distance to the end of the approach after a look; as `value`.
  static double remaining(double before, double change) {
    const double now = std::abs(change);
    if (now == 0) return 0;
    const double ratio = std::min(now / std::abs(before), highest_ratio);
    return now * std::max(1.0, ratio / (1 - ratio));
  }

  const State& state() const { return state_; }
  void set_state(const State& state) { state_ = state; }

 private:
  double change_;
  State state_;
};

}  // namespace silt

#pragma once
// Detects a steady flow from a quantity that is sampled at intervals.
//
// From three successive values v0, v1, v2 and the ratio r = |v2 - v1| / |v1 - v0| of their changes, the
// remaining change of a geometric decay is |v2 - v1| r / (1 - r). The flow is steady when this, or the last
// change if larger, is at most `change` times |v2| at two successive samples. A small change alone is no
// proof: a slow decay changes little between samples, and an oscillation stands still where it turns. Ratios
// above `highest_ratio` cannot be told from rounding and are taken as such: if decay needs more than 1 / (1 -
// highest_ratio) samples, sample less often; if it oscillates within ten, more often.
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace silt {

class SteadyWatch {
 public:
  static constexpr double highest_ratio = 0.99;

  /// The memory of a watch between samples.
  struct State {
    std::int64_t looks = 0;             // with a finite value
    double value = 0, last_change = 0;  // of the last sample; its change from the one before
    std::int64_t within = 0;            // successive samples that found it steady
  };

  /// Watches until at most the share `change` of the value remains.
  explicit SteadyWatch(double change) : change_(change) {}

  /// Adds a sample; one that is not finite restarts the watch.
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
  /// Returns the estimated remaining change after a sample, in units of `value`.
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

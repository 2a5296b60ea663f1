#include "coupler/results/steady_watch.hpp"

#include <algorithm>
#include <cmath>

namespace silt::coupler {

double SteadyWatch::remaining(double before, double change) {
  const double now = std::abs(change);
  if (now == 0) return 0;
  const double ratio = std::min(now / std::abs(before), highest_ratio);
  return now * std::max(1.0, ratio / (1 - ratio));
}

/// A value that is not a number begins everything anew.
void SteadyWatch::look(double value) {
  if (!std::isfinite(value)) {
    state_ = State{};
    return;
  }
  const double change = value - state_.value;
  if (state_.looks >= 2)
    state_.within =
        remaining(state_.last_change, change) <= change_ * std::abs(value) ? state_.within + 1 : 0;
  state_.last_change = change;
  state_.value = value;
  ++state_.looks;
}

}  // namespace silt::coupler

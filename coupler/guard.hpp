#pragma once
// Stops a run whose state has left the range in which it means anything, and says what to change.
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

#include "coupler/case/motion_limits.hpp"

namespace silt::rigid {
struct BodySet;
}

namespace silt::coupler {

struct Case;
struct FlowTotals;

/// GuardStop says that a value left its allowed range. what(): step, where, value, what is allowed, which key
/// to change.
struct GuardStop : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// One that every rank finds alike, in the same step: all come to their end together.
struct CommonGuardStop : GuardStop {
  using GuardStop::GuardStop;
};

/// The fluid is looked at once in so many steps. A look reads every cell once, about the price of two steps:
/// 2 %. An instability grows tenfold in some tens of steps, so not much time is lost before it is seen.
inline constexpr std::int64_t guard_interval = 100;
/// Above this speed (cells a step; sound: 0.58) the scheme's error is of the order of the flow itself.
inline constexpr double highest_speed = 0.4;

/// Checks the totals, alike on every rank for the same totals. Throws CommonGuardStop.
void check_flow(const Case&, const FlowTotals&, std::int64_t step);

/// What to change when contacts go wrong without a fluid.
std::string contact_remedy(const Case&);

/// Checks this rank's bodies and returns their largest speed; GuardStop on the ranks that own a bad one only.
double check_motion(const Case&, const MotionLimits&, const rigid::BodySet&, std::int64_t step, int rank);

/// Returns the text for sums of forces that ran out of range; on this rank, or (no rank) as all ranks know.
std::string overflow_text(const Case&, const std::string& what, std::int64_t step,
                          std::optional<int> rank = {});

}  // namespace silt::coupler

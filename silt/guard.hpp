#pragma once
// Stops a run whose state has left the range in which it means anything, and says what to change.
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

#include "coupler/flow.hpp"
#include "coupler/spec/coarsening_spec.hpp"
#include "lbm/collision/stream_collide.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/contact.hpp"

namespace silt {

struct Case;
class Scene;

/// GuardStop says that a value left its allowed range. what(): step, where, value, what is allowed, which key
/// to change.
struct GuardStop : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// One that every rank finds alike, in the same step: all come to their end together.
struct CommonGuardStop : GuardStop {
  using GuardStop::GuardStop;
};

/// All of the fluid is looked at once in so many steps, a multiple of those of the coarsest cells, about the
/// price of two. In between the dense pass finds what is too fast, in lbm::WatchedPlanes::period steps at
/// most.
inline constexpr std::int64_t guard_interval = 96;
static_assert(guard_interval % (1 << coupler::CoarseningSpec::most_levels) == 0);
/// Above this speed (cells a step) the scheme's error is of the order of the flow itself: what a look finds.
inline constexpr double highest_speed = 0.4;

/// Judges the totals of a scene's flow. Throws CommonGuardStop: the cell, what is beside it, the cure.
/// Collective if something is wrong.
void check_flow(const Scene&, const coupler::FlowTotals&, std::int64_t step);

/// Returns what to change when contacts go wrong without a fluid.
std::string contact_remedy(const Case&);

/// Returns the text for a cell of this rank that is too fast: where it is, what is beside it, the cure.
std::string too_fast_text(const Scene&, const coupler::FluidFields::Fast&, std::int64_t step);

/// Returns the text for a body that would move further in a step than its limit; a speed that is not finite
/// stands for a velocity or position that is no number.
std::string motion_text(const Case&, rigid::BodyId, double speed, double limit, std::int64_t step);

/// Returns the text for two bodies (or a body and a wall) that overlap deeper than half the width of one, and
/// go on; can_part: whether an impulse along the normal moves either.
std::string overlap_text(const Case&, const rigid::Contact&, double half_width, bool can_part,
                         std::int64_t step);

/// Returns the text for bodies whose energy has grown since a step though nothing drives them.
struct EnergyGain {
  double gain, kinetic, allowed;  // kinetic: now
};
std::string energy_text(const Case&, const EnergyGain&, std::int64_t since, std::int64_t step);

/// Returns the text for a body that came too near to coarser cells.
std::string border_text(const Case&, rigid::BodyId, std::int64_t step);

/// Returns the text for sums of forces that ran out of range; on this rank, or (no rank) as all ranks know.
std::string overflow_text(const Case&, const std::string& what, std::int64_t step,
                          std::optional<int> rank = {});

}  // namespace silt

#pragma once
// Stops a run whose state leaves the range in which results are valid, and says what to change.
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

#include "coupler/flow.hpp"
#include "coupler/spec/flow_spec.hpp"
#include "lbm/collision/stream_collide.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/contact.hpp"

namespace silt {

struct Case;
class Scene;

/// A value left its allowed range. what() gives step, place, value, allowed range and the key to change.
struct GuardStop : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// A GuardStop that every rank throws in the same step.
struct CommonGuardStop : GuardStop {
  using GuardStop::GuardStop;
};

/// Steps between two checks of all fluid cells, a multiple of the steps of the coarsest cells; a check costs
/// about two steps. Between them the dense pass finds cells that are too fast within
/// lbm::WatchedPlanes::period steps.
inline constexpr std::int64_t guard_interval = 96;
static_assert(guard_interval % (1 << coupler::CoarseningSpec::most_levels) == 0);
/// The largest speed that a check allows, in cells per step; above it the error of the scheme is as large as
/// the flow.
inline constexpr double highest_speed = 0.4;

/// Checks the totals of a scene's flow. Throws CommonGuardStop with the cell, its surroundings and the
/// remedy. Collective if there is a fault.
void check_flow(const Scene&, const coupler::FlowTotals&, std::int64_t step);

/// Returns what to change when contacts fail without a fluid.
std::string contact_remedy(const Case&);

/// Returns the error for a cell of this rank that is too fast: its place, its surroundings, the remedy.
std::string too_fast_text(const Scene&, const coupler::FluidFields::Fast&, std::int64_t step);

/// Returns the error for a body that would move further in a step than its limit. A speed that is not finite
/// means a velocity or position that is not a number.
std::string motion_text(const Case&, rigid::BodyId, double speed, double limit, std::int64_t step);

/// Returns the error for two bodies (or a body and a wall) that overlap by more than half the width of one
/// and still approach; can_part: whether a normal impulse can move either.
std::string overlap_text(const Case&, const rigid::Contact&, double half_width, bool can_part,
                         std::int64_t step);

/// The growth of energy of bodies that nothing drives; energy_text() returns the error for it.
struct EnergyGain {
  double gain, kinetic, allowed;  // kinetic: at present
};
std::string energy_text(const Case&, const EnergyGain&, std::int64_t since, std::int64_t step);

/// Returns the error for a body that is too close to coarser cells.
std::string border_text(const Case&, rigid::BodyId, std::int64_t step);

/// Returns the error for sums of forces out of range, on one rank or, without `rank`, known to all ranks.
std::string overflow_text(const Case&, const std::string& what, std::int64_t step,
                          std::optional<int> rank = {});

}  // namespace silt

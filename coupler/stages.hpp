#pragma once
// The stages of a step, used by its clock and by the report.
#include <array>
#include <string_view>

#include "parallel/traffic.hpp"
#include "rigid/math/stage_clock.hpp"

namespace silt::coupler {

/// The stages of the paper's Figure 7; the last four are the parts of its "physics engine".
enum class Stage {
  object_mapping,
  lbm_communication,
  stream_collide,
  force_evaluation,
  integrate,
  collision_detection,
  contact_response,
  body_synchronisation,
  count
};
inline constexpr std::array<std::string_view, int(Stage::count)> stage_names = {
    "object mapping", "LBM communication",   "stream collide",   "force evaluation",
    "integrate",      "collision detection", "contact response", "body synchronisation"};

using StepClock = rigid::StageClock<Stage, parallel::Traffic>;
using StageSeconds = StepClock::Seconds;
using StageTraffic = StepClock::Readings;

}  // namespace silt::coupler

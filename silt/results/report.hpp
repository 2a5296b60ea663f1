#pragma once
// report.json: the results of a run for other programs.
#include <cstdint>
#include <string>

#include "silt/results/quantities.hpp"
#include "silt/simulation.hpp"

namespace silt {

/// The state of a run, besides that of its simulation.
struct RunStatus {
  std::string exit_reason = "running";  // "completed", "steady", "interrupted", "guard", "error"
  std::string exit_text;                // for the last three: the reason
  std::int64_t first_step = 0;          // first step of this start: above 0 after a resume
  double wall_seconds = 0;              // since this start
  bool state_is_sound = true;           // false: no hash, no quantities
  bool at_end = true;                   // false: no hash, which costs several steps
};

/// Returns the text of report.json. Times are those since this start; counters and maxima since step 0.
/// Speeds, lengths and quantities are in units of the case. Collective.
std::string report_of(Simulation&, const Quantities&, const RunStatus&);

/// Returns a short report for a run that this rank ends alone.
std::string last_report(const RunStatus&, std::int64_t steps, int ranks);

}  // namespace silt

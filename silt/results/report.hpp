#pragma once
// report.json: the figures of a run that other programs read.
#include <cstdint>
#include <string>

#include "silt/results/quantities.hpp"
#include "silt/simulation.hpp"

namespace silt {

/// The state of a run, besides that of its simulation.
struct RunStatus {
  std::string exit_reason = "running";  // "completed", "steady", "interrupted", "guard", "error"
  std::string exit_text;                // for the last three: what happened
  std::int64_t first_step = 0;          // where this start began: above 0 after a resume
  double wall_seconds = 0;              // since this start
  bool state_is_sound = true;           // false: no hash, no quantities
  bool at_end = true;                   // false: no hash, which takes as long as some steps
};

/// Collective. Returns the text of report.json. Times are those since this start; counters and largest values
/// since step 0. Speeds, lengths and quantities in the units of the case.
std::string report_of(Simulation&, const Quantities&, const RunStatus&);

/// Returns the short report of a run that this rank ends alone.
std::string last_report(const RunStatus&, std::int64_t steps, int ranks);

}  // namespace silt

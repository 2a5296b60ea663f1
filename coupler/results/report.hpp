#pragma once
// report.json: the figures of a run that other programs read.
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "coupler/results/quantities.hpp"
#include "coupler/simulation.hpp"

namespace silt::coupler {

/// How a run stands, beside what its simulation knows.
struct RunStatus {
  std::string exit_reason = "running";  // "completed", "steady", "interrupted", "guard", "error"
  std::string exit_text;                // for the last three: what happened
  std::int64_t first_step = 0;          // where this start began: above 0 after a resume
  double wall_seconds = 0;              // since this start
  bool state_is_sound = true;           // false: no hash, no quantities
  bool at_end = true;                   // false: no hash, which takes as long as some steps
};

struct Report {
  std::string text;  // of report.json
  /// Its numbers, each with its path, "member.key", and as printed; of an array of three "member.x" and so
  /// on. A null is one, with no text: what is not known now.
  std::vector<std::pair<std::string, std::string>> numbers;
};

/// Collective. Times are those since this start; counters and largest values since step 0. Speeds, lengths
/// and quantities in the units of the case.
Report report_of(Simulation&, const Quantities&, const RunStatus&);

/// Returns the short report of a run that this rank ends alone.
std::string last_report(const RunStatus&, std::int64_t steps, int ranks);

/// Whether a file is the report of a run that came to its end at that step.
bool is_final_report(const std::filesystem::path&, std::int64_t step);

}  // namespace silt::coupler

#pragma once
// A run that is to go on and has no step left to do.
#include <filesystem>
#include <string>

#include "coupler/run/prepare_run.hpp"

namespace silt::coupler {

/// Returns why there is no step left to do, or "".
std::string complete_text(const PreparedRun&);

/// Collective. Returns whether report.json is not yet that of the end: the run was killed, or could not write
/// it.
bool lacks_final_report(const std::filesystem::path& folder, const Simulation&);

}  // namespace silt::coupler

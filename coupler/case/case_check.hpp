#pragma once
// Judges a case that could be read: refuses scenes that cannot run, warns of those that will run badly.
#include <vector>

#include "coupler/case/case_error.hpp"

namespace silt::coupler {

struct Case;

/// Returns everything that is wrong (errors) or doubtful (warnings) about a scene, by topic: domain and
/// blocks, fluid and boundaries, bodies, fills, run and output. A case with an error must not be started.
/// Where the bodies are is not looked at: that is for coupler/placement, each rank its own.
std::vector<Diagnostic> check_case(const Case&);

/// Judges as check_case; throws CaseError if there is an error, else returns the warnings.
std::vector<Diagnostic> require_runnable(const Case&);

}  // namespace silt::coupler

#pragma once
// Warnings about doubtful results at the end of a run.
#include <string>
#include <vector>

namespace silt {

class Simulation;

/// Returns one text each for contact sweeps that ended far from convergence in a step, a fluid that was
/// noticeably compressible at a check, and mass that cells took without a fluid neighbour. Collective.
std::vector<std::string> warnings_of(const Simulation&);

}  // namespace silt

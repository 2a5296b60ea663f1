#pragma once
// What a run that came to its end says of its results that are to be doubted.
#include <string>
#include <vector>

namespace silt {

class Simulation;

/// Collective. Returns a text for each: sweeps over contacts that ended far from rest in any step, a fluid
/// that was noticeably compressed at any look, mass that cells took because no neighbour was fluid.
std::vector<std::string> warnings_of(const Simulation&);

}  // namespace silt

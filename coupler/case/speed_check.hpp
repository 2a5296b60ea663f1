#pragma once
// Limits of velocities at which the method is accurate, and stable at all.
#include "coupler/case/body_check.hpp"
#include "coupler/case/units.hpp"

namespace silt::coupler {

/// Reports an error or a warning for a speed (cells a step) that the key gives and that is too high.
void check_speed(const Units&, Findings&, const std::string& key, double speed);

}  // namespace silt::coupler

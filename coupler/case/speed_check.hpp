#pragma once
// Limits of velocities at which the method is accurate, and stable at all.
#include <string>

#include "coupler/case/body_check.hpp"

namespace silt::coupler {

/// Limits in cells a step: the error by compressibility grows with the square of the speed.
inline constexpr double doubtful_velocity = 0.1, impossible_velocity = 0.3;

/// Reports an error or a warning for a speed (cells a step) that the key gives and that is too high, with a
/// time step that makes it low enough.
void check_speed(Findings&, const std::string& key, double speed);

/// Returns " (0.25 m/s)", or nothing in lattice units.
std::string in_metres_a_second(const Case&, double speed);

}  // namespace silt::coupler

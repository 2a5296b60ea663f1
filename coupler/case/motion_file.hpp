#pragma once
// The motion of a wall as a table over time: a CSV file beside the case.
#include <string_view>
#include <vector>

#include "coupler/case/units.hpp"
#include "rigid/bodies/wall_motion.hpp"

namespace silt::coupler {

/// Reads lines of seven numbers, in the units of the case: time, displacement x, y, z, rotation vector x, y,
/// z (radian). A first line of headings, empty lines and lines from # on do not count. In lattice units.
/// std::invalid_argument says which line is wrong; times must grow and there must be two lines or more.
std::vector<rigid::MotionRow> read_motion_file(std::string_view text, const Units&);

}  // namespace silt::coupler

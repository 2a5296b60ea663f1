#pragma once
// The motion of a wall as a table over time: a CSV file beside the case.
#include <string>
#include <vector>

#include "coupler/case/units.hpp"
#include "rigid/bodies/wall_motion.hpp"

namespace silt::coupler {

struct MotionFile {
  std::vector<rigid::MotionRow> rows;  // in lattice units
  int headings = 0;                    // lines
};

/// Reads lines of seven numbers (csv_reader.hpp), in the units of the case: time, displacement x, y, z,
/// rotation vector x, y, z (radian). std::invalid_argument says which line is wrong; times must grow and
/// there must be two lines or more.
MotionFile read_motion_file(const std::string& text, const Units&);

}  // namespace silt::coupler

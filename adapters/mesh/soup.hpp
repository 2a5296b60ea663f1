#pragma once
// Triangles as a file has them: nothing is known of how they hang together.
#include <array>
#include <cstdint>
#include <vector>

#include "rigid/math/types.hpp"

namespace silt::adapters {

struct Soup {
  std::vector<rigid::Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // of points
  bool is_single = false;                               // coordinates are in single precision
};

/// Leaves out points that no triangle has.
void leave_out_unused(Soup&);

}  // namespace silt::adapters

#pragma once
// How much a body's cells weigh, and where: what the exact form of the force needs of the map.
#include <cstdint>

#include "coupler/mapping/solid_map.hpp"

namespace silt::coupler {

/// How many cells a body has, and the sum of their coordinates (canonical, as its position; lower corners).
struct CellSums {
  std::int64_t count = 0, coordinates[3] = {};
};

/// The cells of a mask inside its block: each is counted by the one block that has it.
CellSums cells_of(const lbm::CellBox& box, const BodyMask& mask);

}  // namespace silt::coupler

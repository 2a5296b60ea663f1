#pragma once
// Triangles as a file has them: nothing is known of how they hang together.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "rigid/math/types.hpp"

namespace silt::adapters {

struct Soup {
  std::vector<rigid::Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // of points
};

/// Adds a flat convex polygon as a fan. std::invalid_argument for one of less than three corners, of corners
/// that are not there, or that is not convex; `what` names it.
void add_polygon(Soup&, const std::vector<std::uint32_t>& corners, const std::string& what);

}  // namespace silt::adapters

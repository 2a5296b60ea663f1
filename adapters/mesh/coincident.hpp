#pragma once
// Triangles with the same three corners: doubled ones, and the two sides of fins and membranes of no
// thickness.
#include <cstddef>

#include "adapters/mesh/soup.hpp"

namespace silt::adapters {

struct CoincidentCounts {
  std::size_t duplicate = 0;  // triangles left out of which one stays
  std::size_t thin = 0;       // triangles left out of which none stays: they enclose nothing
};

/// Leaves one of coincident triangles, or none, so that every edge has an even number of triangles: none
/// where they stand out from a closed surface or part a solid, one where the surface would have a hole
/// without. Where both would do, as of a surface each triangle of which is there twice, one. What comes out
/// does not depend on the order of the triangles.
CoincidentCounts leave_out_coincident(std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace silt::adapters

#pragma once
// Points of a soup that are the same become one.
#include "adapters/mesh/coincident.hpp"

namespace silt::adapters {

struct WeldCounts {
  std::size_t degenerate = 0;  // triangles left out
  CoincidentCounts coincident;
};

/// Points closer than `distance` (and chains of such) become the first of them in lexicographic order, points
/// that no triangle has are left out, and so are triangles that lose a corner by it and all but one of those
/// with the same corners. What comes out does not depend on the order of the points.
WeldCounts weld(Soup&, double distance);

}  // namespace silt::adapters

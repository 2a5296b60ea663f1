#pragma once
// From welded triangles to a closed surface that knows its outside.
#include <cstddef>

#include "adapters/mesh/soup.hpp"

namespace silt::adapters {

struct SurfaceCounts {
  std::size_t turned = 0;   // triangles that were the other way about
  std::size_t shells = 0;   // pieces that hang together by edges
  std::size_t hollows = 0;  // of these, those that bound a hollow of another
};

/// Turns triangles so that the whole is counter-clockwise seen from outside: within a shell as its neighbours
/// are, shells outward, but inward where an odd number of others is around them. Shells must not cut one
/// another, which is not looked for. std::invalid_argument says where an edge belongs to one triangle only or
/// to more than two, and which shell has one side only or no volume; `scale` is that of the points to those
/// of the file, for messages.
SurfaceCounts close(Soup&, double scale);

}  // namespace silt::adapters

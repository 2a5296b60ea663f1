#pragma once
// The triangles of a PLY file.
#include <string_view>

#include "adapters/mesh/soup.hpp"

namespace silt::adapters {

/// Reads x, y, z of the element `vertex`, and the lists vertex_indices (or vertex_index) of `face`, polygons,
/// and of `tristrips`, strips of triangles; text or binary, of either end; all else is skipped. Nothing is
/// allocated for what a header only claims. std::invalid_argument says where it goes wrong.
Soup ply_triangles(std::string_view bytes);

}  // namespace silt::adapters

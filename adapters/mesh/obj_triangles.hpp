#pragma once
// The triangles of a Wavefront OBJ file.
#include <string_view>

#include "adapters/mesh/soup.hpp"

namespace silt::adapters {

/// Reads the lines `v` and `f`: corners by their numbers, from 1, or back from the last one, with or without
/// /texture/normal; polygons become triangles. All other lines are skipped but those of free-form surfaces,
/// which are refused. Numbers are double, which Debian's tinyobjloader's are not. std::invalid_argument says
/// where it goes wrong.
Soup obj_triangles(std::string_view text);

}  // namespace silt::adapters

#pragma once
// The triangles of an STL file, text or binary.
#include <array>
#include <string_view>
#include <vector>

#include "rigid/math/types.hpp"

namespace silt::adapters {

using Triangle = std::array<rigid::Vec3, 3>;

struct StlTriangles {
  std::vector<Triangle> triangles;
  bool is_binary = false;  // so coordinates are in single precision
};

/// Reads the bytes of a file, all its solids together. It is binary if its length is the one its count of
/// triangles asks for (some binary files begin with "solid" as well), else text if it begins with "solid" and
/// holds no control characters. The normals in it are not read: the order of the corners says the same.
/// Throws std::invalid_argument that says what the file is, or where it goes wrong.
StlTriangles stl_triangles(std::string_view bytes);

}  // namespace silt::adapters

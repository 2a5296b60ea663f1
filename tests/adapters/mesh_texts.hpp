#pragma once
// Cubes as triangles, and STL files of triangles.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "rigid/math/types.hpp"

namespace silt::tests {

using Facet = std::array<rigid::Vec3, 3>;

/// Two triangles a side of the unit cube; corner i is at its bits.
inline std::vector<std::array<int, 3>> cube_triangles() {
  const int squares[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                             {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  std::vector<std::array<int, 3>> triangles;
  for (const auto& s : squares)
    triangles.push_back({s[0], s[1], s[2]}), triangles.push_back({s[0], s[2], s[3]});
  return triangles;
}
inline rigid::Vec3 cube_corner(int i) {
  return rigid::Vec3(i & 1, i >> 1 & 1, i >> 2 & 1);
}

/// The cube's triangles, their corners seen through a map.
template <class Map>
std::vector<Facet> cube_facets(Map&& map) {
  std::vector<Facet> facets;
  for (const auto& t : cube_triangles())
    facets.push_back({map(cube_corner(t[0])), map(cube_corner(t[1])), map(cube_corner(t[2]))});
  return facets;
}
inline std::vector<Facet> cube_facets() {
  return cube_facets([](const rigid::Vec3& x) { return x; });
}

inline std::string stl_text(const std::vector<Facet>& facets, const char* number = "{:.17g} {:.17g} {:.17g}",
                            const std::string& name = "part") {
  std::string text = "solid " + name + "\n";
  for (const Facet& facet : facets) {
    text += "  facet normal 0 0 1\n    outer loop\n";
    for (const rigid::Vec3& x : facet)
      text += "      vertex " + fmt::format(fmt::runtime(number), x[0], x[1], x[2]) + "\n";
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid " + name + "\n";
}

template <class Number>
void put(std::string& bytes, Number x, bool swapped = false) {
  char stored[sizeof x];
  std::memcpy(stored, &x, sizeof x);
  if (swapped) std::reverse(stored, stored + sizeof x);
  bytes.append(stored, sizeof x);
}

/// With the number of triangles that its header claims, and its numbers in either order of bytes.
inline std::string stl_binary(const std::vector<Facet>& facets, std::string header = "made by a test",
                              std::optional<std::uint32_t> claimed = {}, bool swapped = false) {
  header.resize(80);
  put(header, claimed.value_or(std::uint32_t(facets.size())), swapped);
  for (const Facet& facet : facets) {
    for (int k = 0; k < 3; ++k) put(header, 0.f, swapped);
    for (const rigid::Vec3& x : facet)
      for (int d = 0; d < 3; ++d) put(header, float(x[d]), swapped);
    put(header, std::uint16_t{0x8001});
  }
  return header;
}

}  // namespace silt::tests

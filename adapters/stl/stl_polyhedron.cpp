#include "adapters/stl/stl_polyhedron.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <stdexcept>
#include <string>

#include "adapters/qhull/convex_hull.hpp"
#include "adapters/stl/stl_triangles.hpp"

namespace silt::adapters {

namespace {

using rigid::Vec3;

constexpr double same_volume = 1e-6;  // relative; above it the surface has a dent

struct Surface {
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> triangles;
};

double size_of(const std::vector<Triangle>& triangles) {
  Vec3 lower = triangles[0][0], upper = lower;
  for (const Triangle& t : triangles)
    for (const Vec3& v : t) lower = lower.cwiseMin(v), upper = upper.cwiseMax(v);
  return (upper - lower).maxCoeff();
}

/// Finds points that are within a distance of each other: a grid of that spacing.
class Welder {
 public:
  explicit Welder(double distance) : distance_(distance) {}

  /// The number of the point, or of an earlier one that close.
  int number(const Vec3& x, std::vector<Vec3>& points) {
    const std::array<std::int64_t, 3> cell = cell_of(x);
    for (int k = 0; k < 27; ++k) {
      const auto found = cells_.find({cell[0] + k % 3 - 1, cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1});
      if (found == cells_.end()) continue;
      for (const int i : found->second)
        if ((points[i] - x).norm() <= distance_) return i;
    }
    cells_[cell].push_back(static_cast<int>(points.size()));
    points.push_back(x);
    return static_cast<int>(points.size()) - 1;
  }

 private:
  std::array<std::int64_t, 3> cell_of(const Vec3& x) const {
    constexpr double most = 0x1p62;  // further out the grid is coarser than the numbers
    const auto at = [&](double y) { return std::llround(std::clamp(y / distance_, -most, most)); };
    return {at(x[0]), at(x[1]), at(x[2])};
  }
  double distance_;
  std::map<std::array<std::int64_t, 3>, std::vector<int>> cells_;
};

/// Triangles that shrink to a line are left out: their edges take each other's place.
Surface weld(const std::vector<Triangle>& triangles) {
  if (triangles.size() < 4)
    throw std::invalid_argument("it has " + std::to_string(triangles.size()) +
                                " triangles; a closed surface has at least 4");
  const double size = size_of(triangles);
  if (!(size > 0)) throw std::invalid_argument("all its corners are the same point");
  Surface surface;
  Welder welder(hull_flatness * size);
  for (const Triangle& t : triangles) {
    std::array<int, 3> c;
    for (int k = 0; k < 3; ++k) c[k] = welder.number(t[k], surface.vertices);
    if (c[0] != c[1] && c[1] != c[2] && c[2] != c[0]) surface.triangles.push_back(c);
  }
  return surface;
}

std::string shown(const Vec3& x) {
  char text[96];
  std::snprintf(text, sizeof text, "[%.6g, %.6g, %.6g]", x[0], x[1], x[2]);
  return text;
}

void check_closed(const Surface& surface) {
  std::map<std::array<int, 2>, int> uses;  // of an edge in a direction
  for (const auto& t : surface.triangles)
    for (int k = 0; k < 3; ++k) ++uses[{t[k], t[(k + 1) % 3]}];
  std::size_t open = 0, twice = 0;
  std::array<int, 2> first_open{}, first_twice{};
  for (const auto& [edge, count] : uses) {
    if (count > 1 && twice++ == 0) first_twice = edge;
    if (!uses.contains({edge[1], edge[0]}) && open++ == 0) first_open = edge;
  }
  const auto from_to = [&](const std::array<int, 2>& edge) {
    return "from " + shown(surface.vertices[edge[0]]) + " to " + shown(surface.vertices[edge[1]]);
  };
  if (twice > 0)
    throw std::invalid_argument("two triangles run the same way along " + std::to_string(twice) +
                                (twice == 1 ? " edge, " : " edges, the first ") + from_to(first_twice) +
                                ": some are turned over or doubled; repair the surface");
  if (open > 0)
    throw std::invalid_argument("the surface is not closed: " + std::to_string(open) +
                                (open == 1 ? " open edge, " : " open edges, the first ") +
                                from_to(first_open) + "; close its holes");
}

double volume_of(const Surface& surface) {
  double six = 0;
  const Vec3& apex = surface.vertices[0];
  for (const auto& [a, b, c] : surface.triangles)
    six += (surface.vertices[a] - apex).dot((surface.vertices[b] - apex).cross(surface.vertices[c] - apex));
  return std::abs(six) / 6;
}

}  // namespace

std::shared_ptr<const rigid::PolyhedronMesh> stl_polyhedron(std::string_view bytes, double scale) {
  Surface surface = weld(stl_triangles(bytes));
  check_closed(surface);
  const double volume = volume_of(surface);
  const auto hull_volume = rigid::integrals(*convex_hull(surface.vertices).mesh).volume;
  if (!(std::abs(volume - hull_volume) <= same_volume * hull_volume)) {
    char share[32];
    std::snprintf(share, sizeof share, "%.6g", volume / hull_volume);
    throw std::invalid_argument(
        "the surface is not convex: it encloses " + std::string(share) +
        " of the volume of its hull; cut the body into convex pieces, one file each, and put "
        "them together as a compound");
  }
  for (Vec3& v : surface.vertices) v *= scale;
  return convex_hull(surface.vertices).mesh;
}

}  // namespace silt::adapters

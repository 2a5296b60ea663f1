#include "adapters/mesh/soup.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "rigid/shapes/triangle_mesh.hpp"

namespace silt::adapters {

namespace {

using rigid::TriangleMesh;
using rigid::Vec3;
constexpr std::uint32_t none = ~std::uint32_t{0};

std::string shown(const Vec3& x) {
  char text[96];
  std::snprintf(text, sizeof text, "[%.6g, %.6g, %.6g]", x[0], x[1], x[2]);
  return text;
}

/// The triangles adjacent to each side of each triangle.
class Neighbours {
 public:
  Neighbours(const Soup& soup, double scale) : beyond_(soup.triangles.size(), {none, none, none}) {
    const std::vector<rigid::TriangleSide> sides = rigid::sides_of(soup.triangles);
    Faults open, crowded;
    for (std::size_t i = 0; i < sides.size();) {
      std::size_t end = i + 1;
      while (end < sides.size() && sides[end].same_edge(sides[i])) ++end;
      if (end - i == 1) open.add(sides[i]);
      if (end - i > 2) crowded.add(sides[i]);
      if (end - i == 2) {
        beyond_[sides[i].triangle][sides[i].k] = sides[i + 1].triangle;
        beyond_[sides[i + 1].triangle][sides[i + 1].k] = sides[i].triangle;
      }
      i = end;
    }
    const auto of = [&](const Faults& faults) {
      return std::to_string(faults.count) + (faults.count == 1 ? " edge, " : " edges, the first ") + "from " +
             shown(soup.points[faults.first.low] / scale) + " to " +
             shown(soup.points[faults.first.high] / scale);
    };
    if (crowded.count > 0)
      throw std::invalid_argument("more than two triangles meet in " + of(crowded) +
                                  ": bodies that touch along an edge, or a wall inside; take them apart");
    if (open.count > 0)
      throw std::invalid_argument("the surface is not closed: it ends at " + of(open) +
                                  "; close its holes, and merge corners that should be one");
  }
  std::uint32_t beyond(std::uint32_t triangle, int k) const { return beyond_[triangle][k]; }

 private:
  struct Faults {
    std::size_t count = 0;
    rigid::TriangleSide first{};
    void add(const rigid::TriangleSide& side) {
      if (count++ == 0) first = side;
    }
  };
  std::vector<Triangle> beyond_;
};

bool runs_along(const Triangle& t, std::uint32_t from, std::uint32_t to) {
  for (int k = 0; k < 3; ++k)
    if (t[k] == from && t[(k + 1) % 3] == to) return true;
  return false;
}

void turn(Triangle& t) {
  std::swap(t[1], t[2]);
}

/// Orients the triangles of each shell like its first one; returns the shell of each triangle.
std::vector<std::uint32_t> find_shells(Soup& soup, const Neighbours& neighbours, std::size_t& shells,
                                       double scale) {
  std::vector<std::uint32_t> shell(soup.triangles.size(), none), waiting;
  shells = 0;
  // the neighbours' sides refer to the original orientation
  const std::vector<Triangle> given = soup.triangles;
  for (std::uint32_t start = 0; start < shell.size(); ++start) {
    if (shell[start] != none) continue;
    const auto number = std::uint32_t(shells++);
    shell[start] = number;
    waiting.push_back(start);
    while (!waiting.empty()) {
      const std::uint32_t t = waiting.back();
      waiting.pop_back();
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t a = given[t][k], b = given[t][(k + 1) % 3], n = neighbours.beyond(t, k);
        const bool forward = runs_along(soup.triangles[t], a, b);
        const bool against = runs_along(soup.triangles[n], forward ? b : a, forward ? a : b);
        if (shell[n] == none) {
          if (!against) turn(soup.triangles[n]);
          shell[n] = number;
          waiting.push_back(n);
        } else if (!against) {
          throw std::invalid_argument("the surface has one side only, as a Moebius strip has, at " +
                                      shown(soup.points[a] / scale));
        }
      }
    }
  }
  return shell;
}

/// Reverses shells of negative volume.
void turn_outward(Soup& soup, const std::vector<std::uint32_t>& shell, std::size_t shells, double scale) {
  std::vector<double> volume(shells, 0), size(shells, 0);
  std::vector<std::uint32_t> apex(shells, none);
  for (std::size_t t = 0; t < shell.size(); ++t) {
    const Triangle& corners = soup.triangles[t];
    const std::uint32_t s = shell[t];
    if (apex[s] == none) apex[s] = corners[0];
    const Vec3& o = soup.points[apex[s]];
    const Vec3 a = soup.points[corners[0]] - o, b = soup.points[corners[1]] - o,
               c = soup.points[corners[2]] - o;
    volume[s] += a.dot(b.cross(c)) / 6;
    size[s] = std::max({size[s], a.norm(), b.norm(), c.norm()});
  }
  constexpr double flat = 1e-12;
  for (std::size_t s = 0; s < shells; ++s)
    if (!(std::abs(volume[s]) > flat * size[s] * size[s] * size[s]))
      throw std::invalid_argument("the shell at " + shown(soup.points[apex[s]] / scale) +
                                  " encloses no volume");
  for (std::size_t t = 0; t < shell.size(); ++t)
    if (volume[shell[t]] < 0) turn(soup.triangles[t]);
}

/// Reverses shells inside an odd number of others; returns their number.
std::size_t turn_hollows(Soup& soup, const std::vector<std::uint32_t>& shell, std::size_t shells) {
  if (shells < 2) return 0;
  const TriangleMesh all(soup.points, soup.triangles);
  // the mesh reorders triangles, but not the vertices, which are sorted: so triangles are found by vertices
  std::vector<std::pair<Triangle, std::uint32_t>> by_corners(shell.size());
  const auto first_least = [](Triangle t) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
  };
  for (std::size_t t = 0; t < shell.size(); ++t) by_corners[t] = {first_least(soup.triangles[t]), shell[t]};
  std::sort(by_corners.begin(), by_corners.end());
  const auto shell_of = [&](std::uint32_t triangle) {
    const auto at = std::lower_bound(by_corners.begin(), by_corners.end(),
                                     std::pair(all.triangles()[triangle], std::uint32_t{0}));
    return at->second;
  };
  std::vector<char> is_hollow(shells, 2);  // 2: unknown
  for (std::size_t t = 0; t < shell.size(); ++t) {
    const std::uint32_t own = shell[t];
    if (is_hollow[own] != 2) continue;
    const Triangle& c = soup.triangles[t];
    const Vec3 middle = (soup.points[c[0]] + soup.points[c[1]] + soup.points[c[2]]) / 3;
    is_hollow[own] = all.encloses(middle, [&](std::uint32_t triangle) { return shell_of(triangle) != own; });
  }
  for (std::size_t t = 0; t < shell.size(); ++t)
    if (is_hollow[shell[t]] == 1) turn(soup.triangles[t]);
  return std::size_t(std::count(is_hollow.begin(), is_hollow.end(), 1));
}

}  // namespace

SurfaceCounts close(Soup& soup, double scale) {
  SurfaceCounts counts;
  const std::vector<Triangle> given = soup.triangles;
  const Neighbours neighbours(soup, scale);
  const auto shell = find_shells(soup, neighbours, counts.shells, scale);
  turn_outward(soup, shell, counts.shells, scale);
  counts.hollows = turn_hollows(soup, shell, counts.shells);
  for (std::size_t t = 0; t < given.size(); ++t) counts.turned += soup.triangles[t] != given[t];
  return counts;
}

}  // namespace silt::adapters

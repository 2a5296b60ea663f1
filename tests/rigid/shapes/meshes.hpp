#pragma once
// Closed surfaces of triangles for tests.
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <utility>

#include "rigid/shapes/triangle_mesh.hpp"

namespace silt::rigid::testing {

using Triangles = std::vector<TriangleMesh::Triangle>;

inline TriangleMesh cuboid_mesh(const Vec3& lower, const Vec3& upper) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back(
        {i & 1 ? upper[0] : lower[0], i & 2 ? upper[1] : lower[1], i & 4 ? upper[2] : lower[2]});
  const std::array<std::uint32_t, 4> faces[] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                                {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  Triangles triangles;
  for (const auto& f : faces)
    triangles.push_back({f[0], f[1], f[2]}), triangles.push_back({f[0], f[2], f[3]});
  return {corners, triangles};
}

/// A ring of n times m corners, corner(i, j) with both indices round, and the triangles between them.
inline TriangleMesh ring_mesh(std::uint32_t n, std::uint32_t m, const std::function<Vec3(int, int)>& corner) {
  std::vector<Vec3> corners;
  Triangles triangles;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < m; ++j) {
      corners.push_back(corner(int(i), int(j)));
      const std::uint32_t a = i * m + j, b = (i + 1) % n * m + j, c = (i + 1) % n * m + (j + 1) % m,
                          d = i * m + (j + 1) % m;
      triangles.push_back({a, b, c}), triangles.push_back({a, c, d});
    }
  return {corners, triangles};
}

/// About z; `radius` of the ring, `tube` that of its section.
inline TriangleMesh torus_mesh(double radius, double tube, std::uint32_t n, std::uint32_t m) {
  return ring_mesh(n, m, [=](int i, int j) -> Vec3 {
    const double u = 2 * std::numbers::pi * i / n, v = 2 * std::numbers::pi * j / m;
    const double rho = radius + tube * std::cos(v);
    return {rho * std::cos(u), rho * std::sin(u), tube * std::sin(v)};
  });
}

/// A wheel with a hole and so many teeth about z: a ring of square section whose outer radius steps to and
/// fro, with a flank between; every side divided into `fine` rows. Triangles: 32 teeth fine.
inline TriangleMesh gear_mesh(std::uint32_t teeth, std::uint32_t fine) {
  const std::uint32_t n = 4 * teeth, m = 4 * fine;
  return ring_mesh(n, m, [=](int i, int j) -> Vec3 {
    const double u = 2 * std::numbers::pi * i / n, at = double(j % int(fine)) / fine;
    const double inner = 0.4, outer = i % 4 < 2 ? 1.0 : 0.85, half = 0.2;
    const int side = j / int(fine);
    const double rho = side == 0   ? outer
                       : side == 1 ? outer + at * (inner - outer)
                       : side == 2 ? inner
                                   : inner + at * (outer - inner);
    const double z = side == 0   ? -half + 2 * half * at
                     : side == 1 ? half
                     : side == 2 ? half - 2 * half * at
                                 : -half;
    return {rho * std::cos(u), rho * std::sin(u), z};
  });
}

/// About z; the profile's points are (radius, height), upwards, the first and the last on the axis.
inline TriangleMesh lathe_mesh(const std::vector<std::pair<double, double>>& profile, std::uint32_t n) {
  std::vector<Vec3> corners = {{0, 0, profile.front().second}, {0, 0, profile.back().second}};
  Triangles triangles;
  const auto rings = static_cast<std::uint32_t>(profile.size() - 2);
  for (std::uint32_t k = 0; k < rings; ++k)
    for (std::uint32_t i = 0; i < n; ++i) {
      const double u = 2 * std::numbers::pi * i / n, rho = profile[k + 1].first;
      corners.push_back({rho * std::cos(u), rho * std::sin(u), profile[k + 1].second});
    }
  const auto corner = [&](std::uint32_t k, std::uint32_t i) { return 2 + k * n + i % n; };
  for (std::uint32_t i = 0; i < n; ++i) {
    triangles.push_back({0, corner(0, i + 1), corner(0, i)});
    triangles.push_back({1, corner(rings - 1, i), corner(rings - 1, i + 1)});
    for (std::uint32_t k = 0; k + 1 < rings; ++k) {
      triangles.push_back({corner(k, i), corner(k, i + 1), corner(k + 1, i + 1)});
      triangles.push_back({corner(k, i), corner(k + 1, i + 1), corner(k + 1, i)});
    }
  }
  return {corners, triangles};
}

/// A slab below z = 0, its upper side n times n quads of random corners and diagonals, as its lower one at
/// z = -height.
inline TriangleMesh random_slab(double length, double height, std::uint32_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<> u(-0.4, 0.4);
  std::vector<Vec3> corners;
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t j = 0; j <= n; ++j) {
      const double x = i + (i > 0 && i < n ? u(random) : 0), y = j + (j > 0 && j < n ? u(random) : 0);
      corners.push_back({length * x / n, length * y / n, 0});
    }
  const auto below = static_cast<std::uint32_t>(corners.size());
  for (std::uint32_t k = 0; k < below; ++k) corners.push_back(corners[k] - height * Vec3::UnitZ());
  Triangles triangles;
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return i * (n + 1) + j; };
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    if (random() % 2)
      triangles.push_back({a, b, c}), triangles.push_back({a, c, d});
    else
      triangles.push_back({b, c, d}), triangles.push_back({b, d, a});
  };
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      quad(a, b, c, d);
      quad(below + d, below + c, below + b, below + a);
    }
    const auto side = [&](std::uint32_t a, std::uint32_t b) { quad(below + a, below + b, b, a); };
    side(at(i, 0), at(i + 1, 0));
    side(at(i + 1, n), at(i, n));
    side(at(0, i + 1), at(0, i));
    side(at(n, i), at(n, i + 1));
  }
  return {corners, triangles};
}

/// A sphere of 20 * 4^halvings triangles, corners on it.
inline TriangleMesh icosphere(double radius, int halvings) {
  const double g = std::numbers::phi;
  std::vector<Vec3> corners = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                               {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  Triangles triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                         {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                         {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int h = 0; h < halvings; ++h) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), std::uint32_t(corners.size()));
      if (is_new) corners.push_back(corners[a] + corners[b]);
      return at->second;
    };
    Triangles finer;
    for (Vec3& x : corners) x.normalize();
    for (const auto& [a, b, c] : triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const TriangleMesh::Triangle& t : Triangles{{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
        finer.push_back(t);
    }
    triangles.swap(finer);
  }
  for (Vec3& x : corners) x = radius * x.normalized();
  return {corners, triangles};
}

inline TriangleMesh scaled(const TriangleMesh& mesh, double scale) {
  std::vector<Vec3> corners(mesh.vertices().begin(), mesh.vertices().end());
  for (Vec3& x : corners) x *= scale;
  return {std::move(corners), {mesh.triangles().begin(), mesh.triangles().end()}};
}

/// A cylinder about z between two regular polygons of n corners, whose area is that of the circle.
inline TriangleMesh prism_mesh(double radius, double half_length, std::uint32_t n) {
  const double angle = 2 * std::numbers::pi / n, rho = radius * std::sqrt(angle / std::sin(angle));
  std::vector<Vec3> corners = {{0, 0, -half_length}, {0, 0, half_length}};
  Triangles triangles;
  for (std::uint32_t i = 0; i < n; ++i) {
    for (const double z : {-half_length, half_length})
      corners.push_back({rho * std::cos(angle * i), rho * std::sin(angle * i), z});
    const std::uint32_t a = 2 + 2 * i, b = 2 + 2 * ((i + 1) % n);
    for (const TriangleMesh::Triangle& t :
         Triangles{{0, b, a}, {1, a + 1, b + 1}, {a, b, b + 1}, {a, b + 1, a + 1}})
      triangles.push_back(t);
  }
  return {std::move(corners), std::move(triangles)};
}

inline Mesh solid_of(TriangleMesh surface) {
  return {std::make_shared<const TriangleMesh>(std::move(surface)), false};
}
inline Mesh vessel_of(TriangleMesh surface) {
  return {std::make_shared<const TriangleMesh>(std::move(surface)), true};
}

}  // namespace silt::rigid::testing

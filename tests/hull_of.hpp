#pragma once
// Convex polyhedra for the tests, by brute force.
#include <algorithm>
#include <cmath>
#include <vector>

#include "rigid/shapes/polyhedron.hpp"

namespace silt::tests {

using rigid::Vec3;

/// Returns the points that lie on the plane, in order about its normal.
inline std::vector<int> loop_on(const std::vector<Vec3>& points, const Vec3& normal, double offset,
                                double slack) {
  std::vector<int> loop;
  Vec3 middle = Vec3::Zero();
  for (int i = 0; i < static_cast<int>(points.size()); ++i)
    if (std::abs(normal.dot(points[i]) - offset) <= slack) {
      loop.push_back(i);
      middle += points[i];
    }
  middle /= static_cast<double>(loop.size());
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  auto angle = [&](int i) { return std::atan2((points[i] - middle).dot(v), (points[i] - middle).dot(u)); };
  std::sort(loop.begin(), loop.end(), [&](int i, int j) { return angle(i) < angle(j); });
  return loop;
}

/// The polyhedron whose corners are the points that are corners of their convex hull; coplanar ones share a
/// face.
inline rigid::Polyhedron hull_of(const std::vector<Vec3>& points) {
  const int n = static_cast<int>(points.size());
  std::vector<std::vector<int>> faces;
  constexpr double slack = 1e-10;
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j)
      for (int k = j + 1; k < n; ++k) {
        Vec3 normal = (points[j] - points[i]).cross(points[k] - points[i]).normalized();
        double low = 0, high = 0;
        for (const Vec3& x : points) {
          low = std::min(low, normal.dot(x - points[i]));
          high = std::max(high, normal.dot(x - points[i]));
        }
        if (low < -slack && high > slack) continue;
        if (high > slack) normal = -normal;
        const auto loop = loop_on(points, normal, normal.dot(points[i]), slack);
        auto sorted = loop;
        std::sort(sorted.begin(), sorted.end());
        // each face once: found from its first three corners
        if (sorted[0] == i && sorted[1] == j && sorted[2] == k) faces.push_back(loop);
      }
  std::vector<int> used(n, -1);
  std::vector<Vec3> corners;
  for (auto& face : faces)
    for (int& c : face) {
      if (used[c] < 0) {
        used[c] = static_cast<int>(corners.size());
        corners.push_back(points[c]);
      }
      c = used[c];
    }
  return {rigid::make_polyhedron_mesh(corners, faces)};
}

}  // namespace silt::tests

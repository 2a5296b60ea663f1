#pragma once
// Pairs with a mesh, and how a query about them is put.
#include "rigid/collision/mesh_contacts.hpp"
#include "tests/adapters/collision_scenes.hpp"
#include "tests/rigid/shapes/meshes.hpp"

namespace silt::tests {

using rigid::MeshFeatures;

/// A cuboid whose faces are n times n squares of two triangles each.
inline rigid::TriangleMesh tessellated_cuboid(const Vec3& half, int n) {
  std::map<std::array<int, 3>, std::uint32_t> numbers;
  std::vector<Vec3> corners;
  rigid::testing::Triangles triangles;
  for (int d = 0; d < 3; ++d)
    for (const int side : {0, n})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto number = [&](int u, int v) {
            std::array<int, 3> at{};
            at[d] = side, at[(d + 1) % 3] = i + u, at[(d + 2) % 3] = j + v;
            const auto [found, is_new] = numbers.try_emplace(at, std::uint32_t(corners.size()));
            if (is_new)
              corners.push_back(
                  half.cwiseProduct(Vec3(2. * at[0] / n - 1, 2. * at[1] / n - 1, 2. * at[2] / n - 1)));
            return found->second;
          };
          const std::uint32_t a = number(0, 0), b = number(1, 0), c = number(1, 1), e = number(0, 1);
          if (side == n)
            triangles.push_back({a, b, c}), triangles.push_back({a, c, e});
          else
            triangles.push_back({a, c, b}), triangles.push_back({a, e, c});
        }
  return {corners, triangles};
}

inline MeshFeatures features_of(rigid::TriangleMesh surface, bool hollow = false) {
  return MeshFeatures(rigid::Mesh{std::make_shared<const rigid::TriangleMesh>(std::move(surface)), hollow});
}

inline Points collide_with(rigid::CollisionBackend& backend, const ConvexShape& shape, const Pose& pose,
                           const MeshFeatures& mesh, const Pose& pose_of_mesh, double tolerance = 1) {
  const auto surface = rigid::features_of_polytope(shape);
  Points points;
  rigid::append_mesh_contacts({shape, surface.get(), pose}, {mesh, pose_of_mesh}, tolerance, backend, points);
  return points;
}

}  // namespace silt::tests

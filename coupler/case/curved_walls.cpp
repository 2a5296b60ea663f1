#include "coupler/case/curved_walls.hpp"

#include <algorithm>

#include "coupler/case/case.hpp"
#include "rigid/collision/tube_contacts.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

using rigid::Vec3;

CurvedWalls::CurvedWalls(const Case& scene) {
  for (const CurvedWall& wall : scene.walls)
    if (const auto* tube = wall.tube())
      tubes_.push_back({{tube->radius}, rigid::pose_of(*tube)});
    else if (const auto* mesh = wall.mesh())
      meshes_.push_back({mesh->mesh, mesh->pose(0)});
}

bool CurvedWalls::are_clear_of(const Vec3& centre, double radius) const {
  const auto clear_of_mesh = [&](const PlacedMesh& wall) {
    const Vec3 x = wall.pose.to_body(centre);
    return wall.mesh.surface->nearest(x, radius).distance >= radius && !wall.mesh.contains(x);
  };
  const auto clear_of_tube = [&](const PlacedTube& wall) {
    return rigid::gap_in_tube(rigid::Sphere{radius}, {centre, rigid::Quat::Identity()}, wall.tube,
                              wall.pose) >= 0;
  };
  return std::all_of(tubes_.begin(), tubes_.end(), clear_of_tube) &&
         std::all_of(meshes_.begin(), meshes_.end(), clear_of_mesh);
}

double CurvedWalls::share_left(const rigid::BoundingBox& room, double radius) const {
  if (empty()) return 1;
  constexpr int points = 32;
  const Vec3 step = (room.upper - room.lower) / points;
  int clear = 0;
  for (int z = 0; z < points; ++z)
    for (int y = 0; y < points; ++y)
      for (int x = 0; x < points; ++x)
        clear += are_clear_of(room.lower + step.cwiseProduct(Vec3(x + 0.5, y + 0.5, z + 0.5)), radius);
  return clear / double(points * points * points);
}

}  // namespace silt::coupler

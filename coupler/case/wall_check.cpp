#include "coupler/case/wall_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coupler/case/body_text.hpp"
#include "coupler/case/case.hpp"
#include "coupler/case/mesh_check.hpp"
#include "coupler/case/speed_check.hpp"
#include "rigid/collision/tube_contacts.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {
namespace {

using rigid::Vec3;

/// How far the axis of a tube passes the domain at; 0: through it. By going to and fro between the two.
double distance_from_domain(const Case& scene, const rigid::TubeSpec& tube) {
  constexpr int projections = 1000;
  const Vec3 size(scene.cells[0], scene.cells[1], scene.cells[2]);
  Vec3 on_axis = tube.point, inside;
  for (int i = 0; i < projections; ++i) {
    inside = on_axis.cwiseMax(0.0).cwiseMin(size);
    on_axis = tube.point + tube.axis.dot(inside - tube.point) * tube.axis;
  }
  return (inside - on_axis).norm();
}

/// The hole must not cross a periodic border, unless it is the same on both sides: where the axis is that of
/// the tube. Elsewhere the outermost cells must be solid.
void check_borders(const Case& scene, Findings& findings, std::size_t index) {
  const rigid::TubeSpec& tube = *scene.walls[index].tube();
  constexpr double straight = 1e-12;  // rounding of a unit vector
  for (int d = 0; d < 3; ++d) {
    const double along = std::abs(tube.axis[d]), size = scene.cells[d];
    if (!scene.periodic(d) || along > 1 - straight) continue;
    if (along > straight) {
      findings.error(wall_key(index, "axis"),
                     fmt::format("walls[{}] leaves the domain through its periodic border across {}, at a "
                                 "slant; let its axis be {} or lie across it, or give the domain sides there",
                                 index, "xyz"[d], "xyz"[d]));
      continue;
    }
    const double low = tube.point[d] - tube.radius, high = tube.point[d] + tube.radius;
    if (low >= 0.5 && high <= size - 0.5) continue;
    findings.error(
        wall_key(index, "point"),
        fmt::format("walls[{}] reaches from {} to {} along {}, which is periodic; it must stay half "
                    "a cell within the domain, {} to {}: enlarge the domain, or give it sides there",
                    index, shown_length(scene, low), shown_length(scene, high), "xyz"[d],
                    shown_length(scene, 0.5), shown_length(scene, size - 0.5)));
  }
}

}  // namespace

void find_wall_faults(const Case& scene, Findings& findings) {
  for (std::size_t i = 0; i < scene.walls.size(); ++i) {
    if (scene.walls[i].mesh()) {
      find_mesh_faults(scene, findings, i);
      continue;
    }
    const rigid::TubeSpec& tube = *scene.walls[i].tube();
    check_borders(scene, findings, i);
    if (distance_from_domain(scene, tube) >= tube.radius)
      findings.error(wall_key(i, "point"),
                     fmt::format("walls[{}] has its hole outside the domain: all of it would be solid; move "
                                 "its point, or change its axis or radius",
                                 i));
    if (!scene.fluid) continue;
    check_speed(findings, wall_key(i, "velocity"), std::abs(tube.velocity));
    check_speed(findings, wall_key(i, "angular_velocity"), std::abs(tube.angular_velocity) * tube.radius);
  }
}

namespace {

/// How far a body reaches into a mesh, at least; not above 0 if it is not seen to.
double depth_in_mesh(const Case& scene, const BodySpec& body, const MeshWall& wall, const rigid::Pose& pose) {
  double depth = 0;
  for (const rigid::InnerBall& ball : rigid::inner_balls(scene.shapes[body.shape]))
    depth = std::max(depth,
                     ball.radius - wall.mesh.signed_distance(pose.to_body(body.pose.to_world(ball.centre))));
  return depth;
}

}  // namespace

std::string fault_in_curved_walls(const Case& scene, const BodySpec& body, const std::string& key,
                                  double allowed) {
  for (const CurvedWall& wall : scene.walls) {
    if (const MeshWall* mesh = wall.mesh()) {
      const rigid::Pose pose = mesh->pose(0);
      if (!mesh->mesh.surface) continue;
      const bool is_convex = rigid::convex_parts(scene.shapes[body.shape]).size() == 1;  // no ring on a post
      if (is_convex && mesh->mesh.contains(pose.to_body(body.pose.position)))
        return fmt::format("{} is {}: this is in the solid of the wall '{}', a mesh; move it out", key,
                           shown_point(scene, body.given_position()), wall.name);
      if (const double depth = depth_in_mesh(scene, body, *mesh, pose); depth > allowed)
        return fmt::format("{} is {}: the body reaches at least {} into the wall '{}', a mesh; move it out",
                           key, shown_point(scene, body.given_position()), shown_length(scene, depth),
                           wall.name);
      continue;
    }
    const rigid::Tube tube{wall.tube()->radius};
    const double gap =
        rigid::gap_in_tube(scene.shapes[body.shape], body.pose, tube, rigid::pose_of(*wall.tube()));
    if (gap >= -allowed) continue;
    return fmt::format(
        "{} is {}: the body reaches {} into the wall '{}', a tube of radius {}; move it towards the tube's "
        "axis",
        key, shown_point(scene, body.given_position()), shown_length(scene, -gap), wall.name,
        shown_length(scene, tube.radius));
  }
  return "";
}

}  // namespace silt::coupler

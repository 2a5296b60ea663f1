// Checks curved walls, and bodies in them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "rigid/collision/tube_contacts.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case_check.hpp"
#include "silt/case/case_sections.hpp"

namespace silt {
namespace {

using rigid::TriangleMesh;
using rigid::Vec3;

/// Returns the path of a wall's key, walls[i].key.
std::string wall_key(std::size_t wall, const char* key) {
  return fmt::format("walls[{}].{}", wall, key);
}

/// The shortest ray from the centre of a triangle along (sign 1) or against its normal to a facing triangle,
/// i.e. the width of a gap or thickness of the solid. Samples a limited number of triangles.
struct Thinnest {
  double width = std::numeric_limits<double>::infinity();
  Vec3 place = Vec3::Zero();  // in the frame of the mesh

  Thinnest(const TriangleMesh& mesh, int sign) {
    constexpr std::uint32_t most = 20000;
    constexpr double facing = 0.5, above = 1e-6;  // cosine; share of the mesh size, past the triangle itself
    const auto count = static_cast<std::uint32_t>(mesh.triangles().size());
    const Vec3 size = mesh.box().upper - mesh.box().lower;
    const double start = above * size.maxCoeff();
    for (std::uint32_t t = 0; t < count; t += 1 + count / most) {
      const auto [a, b, c] = mesh.corners(t);
      const Vec3 normal = mesh.area_normal(t);
      if (!(normal.squaredNorm() > 0)) continue;
      const Vec3 direction = sign * normal.normalized(), middle = (a + b + c) / 3;
      const auto hit =
          mesh.first_hit(middle + start * direction, direction, std::min(width, 2 * size.norm()));
      if (!hit || hit->triangle == t) continue;
      const Vec3 other = mesh.area_normal(hit->triangle);
      if (other.dot(normal) > -facing * other.norm() * normal.norm()) continue;
      if (hit->t + start < width) width = hit->t + start, place = middle;
    }
  }
};

void check_features(const Case& setup, Diagnostics& findings, std::size_t index, const MeshWall& wall) {
  constexpr double thin = 1, coarse = 2;  // cells
  const int solid = wall.mesh.hollow ? 1 : -1;
  for (const int sign : {solid, -solid}) {
    const Thinnest found(*wall.mesh.surface, sign);
    if (found.width >= coarse) continue;
    findings.warning(wall_key(index, "file"),
                     "walls[{}] has {} of {} at {}, {}; use smaller cells, or a mesh without it", index,
                     sign == solid ? "a thickness" : "a gap", shown_length(setup, found.width),
                     shown_point(setup, wall.pose(0).to_world(found.place)),
                     found.width < thin ? "thinner than a cell: parts of it are missing on the lattice"
                                        : "less than two cells: the flow about it is not resolved");
  }
}

/// Says whether a surface of some box is seen by the lattice at the start: it is not where it surrounds the
/// domain, and where it is smaller than a cell.
bool is_seen(const Case& setup, const MeshWall& wall, const rigid::BoundingBox& box) {
  if ((box.upper - box.lower).maxCoeff() < 1) return false;
  const rigid::BoundingBox domain = box_of(setup);
  if (!box.contains(domain.lower) || !box.contains(domain.upper)) return true;
  const rigid::Pose pose = wall.pose(0);
  const rigid::Mat3 turn = pose.orientation.conjugate().toRotationMatrix();
  const Vec3 half = 0.5 * (domain.upper - domain.lower);
  const auto near = rigid::BoundingBox::around(pose.to_body(domain.lower + half), turn.cwiseAbs() * half);
  bool meets = false;
  wall.mesh.surface->for_near(near, [&](std::uint32_t triangle) {
    const auto [a, b, c] = wall.mesh.surface->corners(triangle);
    meets |= (a.cwiseMin(b).cwiseMin(c).array() <= near.upper.array()).all() &&
             (a.cwiseMax(b).cwiseMax(c).array() >= near.lower.array()).all();
  });
  return meets;
}

/// The scale of its file must be such that the domain and the lattice can have it.
bool check_scale(const Case& setup, Diagnostics& findings, std::size_t index, const MeshWall& wall) {
  const rigid::BoundingBox box = rigid::Mesh{wall.mesh.surface, false}.bounding_box(wall.pose(0));
  const std::string entry = fmt::format("walls[{}]", index), key = wall_key(index, "scale");
  const std::string slip = scale_slip(setup, entry, (box.upper - box.lower).maxCoeff());
  if (!slip.empty()) {
    findings.error(key, "{}", slip);
  } else if (setup.fluid && !is_seen(setup, wall, box)) {
    findings.error(key,
                   "{} reaches from {}, the domain from {}: it touches none of its cells; correct {}.scale, "
                   "or move it",
                   entry, shown_box(setup, box), shown_box(setup, box_of(setup)), entry);
  } else {
    return true;
  }
  return false;
}

constexpr int looks = 1000;  // instants of a motion that is looked at

/// Checks that a wall overlaps the domain at an instant, and that a vessel which crosses a periodic border
/// continues on both sides. Returns whether both hold.
bool check_place_at(const Case& setup, Diagnostics& findings, std::size_t index, const MeshWall& wall,
                    double step) {
  constexpr double beyond = 3;  // cells: of the map's ghost layers
  const rigid::BoundingBox box = rigid::Mesh{wall.mesh.surface, false}.bounding_box(wall.pose(step));
  bool good = true;
  for (int d = 0; d < 3; ++d) {
    const double low = box.lower[d], high = box.upper[d], size = setup.cells[d];
    const auto reach = fmt::format("walls[{}] reaches from {} to {} along {}{}", index,
                                   shown_length(setup, low), shown_length(setup, high), "xyz"[d],
                                   step > 0 ? fmt::format(" in step {:.0f}", step) : "");
    const bool crosses = low < 0.5 || high > size - 0.5;
    const bool goes_on = low <= -beyond && high >= size + beyond;
    if (!setup.periodic(d) && (high <= 0 || low >= size) && step == 0)
      findings.error(wall_key(index, "position"),
                     "{}; the domain is from 0 to {}: move it, or correct its scale", reach,
                     shown_length(setup, size));
    else if (wall.mesh.hollow && setup.periodic(d) && crosses && !goes_on)
      findings.error(wall_key(index, step > 0 ? "motion" : "position"),
                     "{}, which is periodic; a vessel must stay half a cell within the domain there, or "
                     "continue unchanged for {} beyond both sides",
                     reach, shown_length(setup, beyond));
    else
      continue;
    good = false;
  }
  return good;
}

void check_mesh(const Case& setup, Diagnostics& findings, std::size_t index, const MeshWall& wall) {
  if (!check_scale(setup, findings, index, wall)) return;
  const int instants = wall.motion.moves() ? looks : 0;
  for (int k = 0; k <= instants; ++k)
    if (!check_place_at(setup, findings, index, wall, std::floor(double(setup.steps) * k / looks))) break;
  if (!setup.fluid) return;
  check_features(setup, findings, index, wall);
  if (wall.motion.moves())
    check_speed(findings, wall_key(index, "motion"), wall.motion.speed_bound(wall.reach()));
}

/// Warns of an axis and point of a wall that neither rotation nor torques use.
void look_for_idle_axis(const Case& setup, Diagnostics& findings, std::size_t index, const MeshWall& wall) {
  const auto is_of_its_torque = [&](const QuantitySpec& q) {
    return q.wall == int(index) && q.type.ends_with("torque") &&
           (q.bearer == Bearer::wall || quantity_type(q.type).takes(QuantityType::wall));
  };
  if (std::ranges::any_of(setup.quantities, is_of_its_torque) || !wall.motion.angular_velocity.isZero(0))
    return;
  constexpr const char* why = "the wall does not turn about it; give angular_velocity";
  findings.idle(wall_key(index, "motion.axis"), why);
  if (wall.table.empty()) findings.idle(wall_key(index, "motion.point"), why);
}

/// Returns whether a point of the domain is in the hole of a tube, by alternating projections.
bool is_open(const Case& setup, const rigid::TubeWallSpec& wall) {
  constexpr int projections = 1000;
  const rigid::BoundingBox domain = box_of(setup);
  const rigid::Pose pose = wall.pose();
  Vec3 in_hole = wall.point, in_domain;
  for (int i = 0; i < projections; ++i) {
    in_domain = in_hole.cwiseMax(domain.lower).cwiseMin(domain.upper);
    in_hole = pose.to_world({0, 0, pose.to_body(in_domain)[2]});
  }
  return wall.tube.gap(pose, in_domain) > 0;
}

/// Checks that a hole crosses a periodic border only if both sides match (axis of the tube), and that
/// elsewhere the outermost cells are solid.
void check_borders(const Case& setup, Diagnostics& findings, std::size_t index,
                   const rigid::TubeWallSpec& wall) {
  constexpr double straight = 1e-12;  // rounding of a unit vector
  const rigid::BoundingBox hole = wall.tube.hole(wall.pose());
  for (int d = 0; d < 3; ++d) {
    const double low = hole.lower[d], high = hole.upper[d], size = setup.cells[d];
    if (!setup.periodic(d) || std::abs(wall.axis[d]) > 1 - straight) continue;
    if (!std::isfinite(high - low))
      findings.error(wall_key(index, "axis"),
                     "walls[{}] leaves the domain through its periodic border across {} obliquely; make its "
                     "axis parallel or normal to {}, or give the domain sides there",
                     index, "xyz"[d], "xyz"[d]);
    else if (low < 0.5 || high > size - 0.5)
      findings.error(wall_key(index, "point"),
                     "walls[{}] reaches from {} to {} along {}, which is periodic; it must stay half a cell "
                     "within the domain, {} to {}: enlarge the domain, or give it sides there",
                     index, shown_length(setup, low), shown_length(setup, high), "xyz"[d],
                     shown_length(setup, 0.5), shown_length(setup, size - 0.5));
  }
}

void check_tube(const Case& setup, Diagnostics& findings, std::size_t index,
                const rigid::TubeWallSpec& wall) {
  check_borders(setup, findings, index, wall);
  if (!is_open(setup, wall))
    findings.error(wall_key(index, "point"),
                   "walls[{}] has its hole outside the domain: all of it would be solid; move its point, or "
                   "change its axis or radius",
                   index);
  if (!setup.fluid) return;
  check_speed(findings, wall_key(index, "angular_velocity"),
              std::abs(wall.angular_velocity) * wall.tube.radius);
}

/// Returns a lower bound of the depth of a body in a mesh; not above 0 if none is found.
double depth_in_mesh(const Case& setup, const BodySpec& body, const MeshWall& wall, const rigid::Pose& pose) {
  double depth = 0;
  for (const rigid::InnerBall& ball : rigid::inner_balls(setup.shapes[body.shape]))
    depth = std::max(depth,
                     ball.radius - wall.mesh.signed_distance(pose.to_body(body.pose.to_world(ball.centre))));
  return depth;
}

}  // namespace

void find_wall_faults(const Case& setup, Diagnostics& findings) {
  for (std::size_t i = 0; i < setup.walls.size(); ++i)
    if (const MeshWall* mesh = setup.walls[i].mesh()) {
      check_mesh(setup, findings, i, *mesh);
      look_for_idle_axis(setup, findings, i, *mesh);
    } else {
      check_tube(setup, findings, i, *setup.walls[i].tube());
    }
}

std::string fault_in_curved_walls(const Case& setup, const BodySpec& body, const std::string& key,
                                  double allowed, double time) {
  const rigid::Shape& shape = setup.shapes[body.shape];
  const std::string is = fmt::format("{} is {}", key, shown_point(setup, body.given_position()));
  for (const CurvedWall& wall : setup.walls) {
    if (const MeshWall* mesh = wall.mesh()) {
      const rigid::Pose pose = mesh->pose(time);
      if (!mesh->mesh.surface) continue;
      const bool is_convex = rigid::convex_parts(shape).size() == 1;  // not a ring on a post
      if (is_convex && mesh->mesh.contains(pose.to_body(body.pose.position)))
        return fmt::format("{}: this is in the solid of the wall '{}', a mesh; move it out", is, wall.name);
      if (const double depth = depth_in_mesh(setup, body, *mesh, pose); depth > allowed)
        return fmt::format("{}: the body reaches at least {} into the wall '{}', a mesh; move it out", is,
                           shown_length(setup, depth), wall.name);
      continue;
    }
    const rigid::Tube& tube = wall.tube()->tube;
    const double gap = rigid::gap_in_tube(shape, body.pose, tube, wall.tube()->pose());
    if (gap >= -allowed) continue;
    return fmt::format(
        "{}: the body reaches {} into the wall '{}', a tube of radius {}; move it towards the tube's axis",
        is, shown_length(setup, -gap), wall.name, shown_length(setup, tube.radius));
  }
  return "";
}

}  // namespace silt

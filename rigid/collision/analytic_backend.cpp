#include "rigid/collision/analytic_backend.hpp"

#include "rigid/collision/convex_manifold.hpp"
#include "rigid/collision/deepest.hpp"
#include "rigid/collision/deepest_direction.hpp"
#include "rigid/collision/manifold.hpp"

namespace silt::rigid {

namespace {

/// Two spheres, the pair that most scenes ask about most: without cores.
void collide_spheres(double radius_a, const Vec3& centre_a, double radius_b, const Vec3& centre_b,
                     double tolerance, std::vector<ContactPoint>& out) {
  const Vec3 d = centre_b - centre_a;
  const double distance = d.norm(), radii = radius_a + radius_b, gap = distance - radii;
  if (gap > tolerance) return;
  // concentric to rounding: any unit vector will do, the same one every time
  const Vec3 normal = distance > 1e-13 * radii ? Vec3(d / distance) : Vec3(Vec3::UnitZ());
  const Vec3 on_a = centre_a + radius_a * normal;
  out.push_back({on_a, on_a + gap * normal, normal, gap, feature_id({}, {})});
}

/// A pair of which one is a cylinder, an ellipsoid or a polyhedron.
void collide_convex(const ConvexShape& shape_a, const Pose& pose_a, const ConvexShape& shape_b,
                    const Pose& pose_b, double tolerance, std::vector<ContactPoint>& out) {
  const ConvexCore a = convex_core(shape_a, pose_a);
  if (const auto* wall = std::get_if<HalfSpace>(&shape_b))
    return append_convex_plane_manifold(a, pose_b.position, pose_b.orientation * wall->normal, tolerance,
                                        out);
  const ConvexCore b = convex_core(shape_b, pose_b);
  const double reach = tolerance + a.radius + b.radius;
  if (const auto found = deepest_direction(a, b, reach))
    append_convex_manifold(a, b, found->peak.normal, found->peak.core_gap, found->where, tolerance, out);
}

}  // namespace

void AnalyticBackend::collide(const ConvexShape& a, const Pose& pose_a, const ConvexShape& b,
                              const Pose& pose_b, double tolerance, std::vector<ContactPoint>& out) {
  ++counters_.queries;
  if (const auto* sphere_a = std::get_if<Sphere>(&a), *sphere_b = std::get_if<Sphere>(&b);
      sphere_a && sphere_b)
    return collide_spheres(sphere_a->radius, pose_a.position, sphere_b->radius, pose_b.position, tolerance,
                           out);
  if (!has_rounded_box(a) || !(has_rounded_box(b) || std::holds_alternative<HalfSpace>(b)))
    return collide_convex(a, pose_a, b, pose_b, tolerance, out);
  const RoundedBox core_a = rounded_box(a, pose_a);
  if (const auto* wall = std::get_if<HalfSpace>(&b))
    return append_plane_manifold(core_a, pose_b.position, pose_b.orientation * wall->normal, tolerance, out);
  const RoundedBox core_b = rounded_box(b, pose_b);
  if (const auto deepest = deepest_separation(core_a, core_b, tolerance))
    append_manifold(core_a, core_b, deepest->normal, deepest->core_gap, tolerance, out);
}

}  // namespace silt::rigid

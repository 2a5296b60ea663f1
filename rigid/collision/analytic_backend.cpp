#include "rigid/collision/analytic_backend.hpp"

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

}  // namespace

void AnalyticBackend::collide(const ConvexShape& a, const Pose& pose_a, const ConvexShape& b,
                              const Pose& pose_b, double tolerance, std::vector<ContactPoint>& out) {
  ++counters_.queries;
  if (const auto* sphere_a = std::get_if<Sphere>(&a), *sphere_b = std::get_if<Sphere>(&b);
      sphere_a && sphere_b)
    return collide_spheres(sphere_a->radius, pose_a.position, sphere_b->radius, pose_b.position, tolerance,
                           out);
  const ConvexCore core_a = convex_core(a, pose_a);
  if (const auto* wall = std::get_if<HalfSpace>(&b))
    return append_plane_manifold(core_a, pose_b.position, pose_b.orientation * wall->normal, tolerance, out);
  const ConvexCore core_b = convex_core(b, pose_b);
  if (const auto found = nearest_approach(core_a, core_b, tolerance))
    append_manifold(core_a, core_b, *found, tolerance, out);
}

}  // namespace silt::rigid

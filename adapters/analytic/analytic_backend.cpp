#include "adapters/analytic/analytic_backend.hpp"

#include "adapters/analytic/deepest.hpp"
#include "adapters/common/manifold.hpp"

namespace silt::adapters {

using rigid::ConvexShape;
using rigid::HalfSpace;
using rigid::Pose;

bool AnalyticBackend::supports(const ConvexShape& a, const ConvexShape&) const {
  return !std::holds_alternative<HalfSpace>(a);
}

void AnalyticBackend::collide(const ConvexShape& a, const Pose& pose_a, const ConvexShape& b,
                              const Pose& pose_b, double tolerance, std::vector<rigid::ContactPoint>& out) {
  ++counters_.queries;
  const RoundedBox core_a = rounded_box(a, pose_a);
  if (const auto* wall = std::get_if<HalfSpace>(&b))
    return append_plane_manifold(core_a, pose_b.position, pose_b.orientation * wall->normal, tolerance, out);
  const RoundedBox core_b = rounded_box(b, pose_b);
  if (const auto deepest = deepest_separation(core_a, core_b, tolerance))
    append_manifold(core_a, core_b, deepest->normal, deepest->core_gap, tolerance, out);
}

}  // namespace silt::adapters

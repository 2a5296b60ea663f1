#include "rigid/collision/depth_proof.hpp"

#include <algorithm>
#include <cmath>

#include "rigid/math/elementary.hpp"

namespace silt::rigid {

namespace {

constexpr double touching_slack = 1e-10;  // part of the pair's size: corners of an edge that touch

/// From x on the edge to its nearer end.
double room(const ContactOutline& edge, const Vec3& x) {
  return std::min((edge.corners[0].x - x).norm(), (edge.corners[1].x - x).norm());
}

Vec3 along(const ContactOutline& edge) {
  return (edge.corners[1].x - edge.corners[0].x).normalized();
}

/// Radius of a disc about where two edges cross, within the face that they span; 0 where they are no edges.
double disc_of_edges(const ConvexCore& a, const ConvexCore& b, const Vec3& n, const CommonPoint& where) {
  thread_local ContactOutline of_a, of_b;
  const double slack = touching_slack * length_scale(a, b);
  a.touching_outline(n, slack, of_a);
  b.touching_outline(-n, slack, of_b);
  if (of_a.size() != 2 || of_b.size() != 2) return 0;
  return std::min(room(of_a, where.on_a), room(of_b, where.on_b)) * along(of_a).cross(along(of_b)).norm();
}

}  // namespace

bool is_least_depth(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double depth,
                    const CommonPoint& where) {
  if (a.touching_ball(where.on_a, n) + b.touching_ball(where.on_b, -n) >= depth) return true;
  if (!a.is_solid_polytope() || !b.is_solid_polytope()) return false;
  const double covered = 2 * elementary::atan2(disc_of_edges(a, b, n, where), depth);
  const Vec3 centre = b.centre - a.centre;
  const double ahead = centre.dot(n), aside = (centre - ahead * n).norm();
  const double behind = elementary::atan2(aside, ahead);  // the angle at which the ball reaches least far
  return covered >= behind &&
         a.central_ball() + b.central_ball() - centre.norm() * elementary::cos(covered - behind) >= depth;
}

}  // namespace silt::rigid

#include "rigid/collision/deepest_direction.hpp"

#include <algorithm>
#include <cmath>

namespace silt::rigid {

namespace {

constexpr double touching_slack = 1e-10;  // part of the pair's size: corners of an edge that touch

/// How far the line of the core that x is on, or the rim of its disc, goes on from there, where unit n is an
/// outward normal: as a form of the part of a direction across n (depth_proof.hpp). Of both, which may be of
/// one core, half each: it has what lies in the middle between them.
Mat3 reach_of_edges(const ConvexCore& core, const Vec3& x, const Vec3& n, double slack) {
  Mat3 reach = Mat3::Zero();
  thread_local ContactOutline outline;
  core.touching_outline(n, slack, outline);
  const double share = core.is_revolved() ? 0.5 : 1.0;
  if (outline.size() == 2) {
    const Vec3 to_ends[2] = {outline.corners[0].x - x, outline.corners[1].x - x};
    const Vec3 along = (to_ends[1] - to_ends[0]).normalized();
    reach += share * std::min(to_ends[0].norm(), to_ends[1].norm()) * along * along.transpose();
  }
  if (core.is_revolved()) {
    const Vec3 round = core.axes.col(2).cross(x - core.centre);  // along the rim, as long as its radius
    if (const double radius = round.norm(); radius > 0)
      reach += share * round * round.transpose() / (2 * radius);
  }
  return reach;
}

/// The least value of a form of unit vectors across unit n.
double least_across(const Mat3& form, const Vec3& n) {
  const Vec3 t = n.unitOrthogonal(), u = n.cross(t);
  const double tt = t.dot(form * t), tu = t.dot(form * u), uu = u.dot(form * u);
  return 0.5 * (tt + uu - std::sqrt((tt - uu) * (tt - uu) + 4 * tu * tu));
}

/// Whether balls inside the cores reach further than `depth` in all directions more than 90 degrees from n.
bool reach_behind(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double depth,
                  const CommonPoint& where) {
  const InnerBall in_a = a.inner_ball(where.on_a), in_b = b.inner_ball(where.on_b);
  const Vec3 centres = in_b.centre - in_a.centre;
  const double ahead = centres.dot(n), most = ahead > 0 ? (centres - ahead * n).norm() : centres.norm();
  return in_a.radius + in_b.radius - most >= depth;
}

}  // namespace

bool is_least_depth(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double depth,
                    const CommonPoint& where) {
  const double ball_a = a.touching_ball(where.on_a, n), ball_b = b.touching_ball(where.on_b, -n);
  if (ball_a + ball_b >= depth) return true;
  if (!reach_behind(a, b, n, depth, where)) return false;
  const double slack = touching_slack * length_scale(a, b);
  const Mat3 edges_a = reach_of_edges(a, where.on_a, n, slack),
             edges_b = reach_of_edges(b, where.on_b, -n, slack);
  return least_across(edges_a + edges_b, n) >= depth || least_across(edges_a, n) + ball_b >= depth ||
         ball_a + least_across(edges_b, n) >= depth;
}

}  // namespace silt::rigid

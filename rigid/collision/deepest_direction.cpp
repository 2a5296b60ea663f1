#include "rigid/collision/deepest_direction.hpp"

#include <algorithm>
#include <cmath>

namespace silt::rigid {
namespace {

/// Largest miss of two points that count as common, relative to the pair's size.
constexpr double meeting_slack = 1e-10;
/// Tolerance of the proof that a direction is the best one, relative to the pair's size.
constexpr double proven = 1e-12;
/// Radians: angle within which edges and faces are tried where search_resolution did not lead to a maximum.
constexpr double widest_angle = 0.6;

CommonPoint meeting_point(const ConvexCore& a, const ConvexCore& b, const Peak& peak) {
  const Vec3& n = peak.normal;
  thread_local ContactOutline of_a, of_b;
  const double scale = length_scale(a, b);
  CommonPoint best{};
  best.miss = std::numeric_limits<double>::infinity();
  // a normal with a rounding error may exclude a corner of an edge or a face
  for (const double slack :
       {meeting_slack * scale, 100 * meeting_slack * scale, 1e4 * meeting_slack * scale}) {
    a.touching_outline(n, slack, of_a);
    b.touching_outline(-n, slack, of_b);
    const CommonPoint p = common_point(of_a, of_b, n, peak.core_gap, 10 * slack);
    if (p.miss < best.miss) best = p;
    if (best.miss <= proven * scale) break;
  }
  return best;
}

Approach meet(const ConvexCore& a, const ConvexCore& b, const Peak& peak) {
  return {peak, meeting_point(a, b, peak)};
}

/// Improves an approach whose cores have no common point on the normal: the maximum is narrow or very flat.
void improve(const ConvexCore& a, const ConvexCore& b, Approach& found) {
  const auto consider = [&](const Peak& other) {
    if (other.core_gap > found.peak.core_gap) found = meet(a, b, other);
  };
  // if the cores hardly touch, their nearest points give the direction
  if (const Vec3 between = found.where.on_b - found.where.on_a; between.dot(found.peak.normal) > 0)
    consider(climb(a, b, between.normalized(), search_resolution));
  consider(climb(a, b, found.peak.normal, widest_angle));
  if (const auto apart = gjk_direction(a, b, Vec3::Zero(), found.peak.normal))
    consider(climb(a, b, *apart, widest_angle));
}

/// Returns whether the separation is proven to be the largest; see proven_direction().
bool is_best(const ConvexCore& a, const ConvexCore& b, const Approach& found) {
  const double slack = proven * length_scale(a, b), gap = found.peak.core_gap + slack;
  if (!(found.where.miss <= slack)) return false;
  return gap >= 0 || is_least_depth(a, b, found.peak.normal, -gap, found.where);
}

/// Makes an approach from the least depth of the cores, which needs no proof.
Approach overlap(const ConvexCore& a, const ConvexCore& b, const Peak& least) {
  Approach found = meet(a, b, least);
  if (found.where.miss > proven * length_scale(a, b)) improve(a, b, found);
  return found;
}

/// Returns (A + B)^-1 d for two ellipsoids with quadratic forms A and B at distance d.
Vec3 between_ellipsoids(const ConvexCore& a, const ConvexCore& b) {
  const auto form = [](const ConvexCore& c) -> Mat3 {
    return c.axes * c.half.cwiseAbs2().asDiagonal() * c.axes.transpose();
  };
  return ((form(a) + form(b)).inverse() * between_centres(a, b)).normalized();
}

/// For polyhedra of more vertices GJK is faster than climb(), which tries many faces.
bool has_few_corners(const ConvexCore& core) {
  constexpr std::size_t most = 48;
  const auto* const polyhedron = std::get_if<Polyhedron>(core.shape);
  return !polyhedron || polyhedron->mesh->vertices.size() <= most;
}

constexpr double touching_slack = 1e-10;  // relative to the pair's size

/// Returns how far the line or the rim of a disc on which x lies extends from there, as a quadratic form of
/// the part of a direction across the outward unit normal n (is_least_depth). If both sources belong to one
/// core, each counts half: the core contains the points midway between them.
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
    const Vec3 round = core.axes.col(2).cross(x - core.centre);  // tangent of the rim, times its radius
    if (const double radius = round.norm(); radius > 0)
      reach += share * round * round.transpose() / (2 * radius);
  }
  return reach;
}

/// Returns the least value of a quadratic form over unit vectors normal to unit n.
double least_across(const Mat3& form, const Vec3& n) {
  const Vec3 t = n.unitOrthogonal(), u = n.cross(t);
  const double tt = t.dot(form * t), tu = t.dot(form * u), uu = u.dot(form * u);
  return 0.5 * (tt + uu - std::sqrt((tt - uu) * (tt - uu) + 4 * tu * tu));
}

/// Returns whether balls inside the cores cover the separation in all directions more than 90 degrees from n.
bool reach_behind(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double depth,
                  const CommonPoint& where) {
  const InnerBall in_a = a.inner_ball(where.on_a), in_b = b.inner_ball(where.on_b);
  const Vec3 centres = in_b.centre - in_a.centre;
  const double ahead = centres.dot(n), most = ahead > 0 ? (centres - ahead * n).norm() : centres.norm();
  return in_a.radius + in_b.radius - most >= depth;
}

}  // namespace

Vec3 between_centres(const ConvexCore& a, const ConvexCore& b) {
  const Vec3 d = b.centre - a.centre;
  const double distance = d.norm();
  return distance > 1e-13 * length_scale(a, b) ? Vec3(d / distance) : Vec3(Vec3::UnitZ());
}

std::optional<Approach> nearest_approach(const ConvexCore& a, const ConvexCore& b, double tolerance) {
  if (!a.is_box || !b.is_box) return deepest_direction(a, b, tolerance + a.radius + b.radius);
  const auto found = deepest_separation(a, b, tolerance);
  return found ? std::optional(Approach{*found, {}}) : std::nullopt;
}

std::optional<Approach> deepest_direction(const ConvexCore& a, const ConvexCore& b, double reach) {
  const Vec3 n = between_centres(a, b);
  if (core_separation(a, b, n) > reach) return {};
  if ((a.curved() || b.curved()) && has_few_corners(a) && has_few_corners(b)) {
    Peak peak{a.is<Ellipsoid>() || b.is<Ellipsoid>() ? between_ellipsoids(a, b) : n, 0};
    for (const int rounds : {1, climb_rounds}) {
      peak = climb(a, b, peak.normal, widest_angle, rounds);
      if (peak.core_gap > reach) return {};
      if (const Approach found = meet(a, b, peak); is_best(a, b, found)) return found;
    }
  }
  if (const auto apart = gjk_direction(a, b, Vec3::Zero(), n)) return proven_direction(a, b, *apart, reach);
  if (!has_few_edges(a, b)) return proven_direction(a, b, walk_uphill(a, b, n), reach);
  const Peak least = least_depth(a, b);
  return least.core_gap < 0 ? overlap(a, b, least) : proven_direction(a, b, least.normal, reach);
}

std::optional<Approach> proven_direction(const ConvexCore& a, const ConvexCore& b, const Vec3& n,
                                         double reach) {
  const double slack = proven * length_scale(a, b);
  Approach found = meet(a, b, climb(a, b, n, search_resolution));
  if (found.peak.core_gap > reach) return {};
  if (found.where.miss > slack) improve(a, b, found);
  if (is_best(a, b, found)) return found;
  if (found.peak.core_gap < 0 && has_few_edges(a, b))
    if (const Peak least = least_depth(a, b); least.core_gap < 0) return overlap(a, b, least);
  const auto best = search_directions(a, b, found.peak, reach);
  if (!best) return {};
  if (best->normal != found.peak.normal) found = meet(a, b, *best);
  if (found.where.miss > slack) improve(a, b, found);
  return found;
}

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

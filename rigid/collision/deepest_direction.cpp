#include "rigid/collision/deepest_direction.hpp"

namespace silt::rigid {

namespace {

/// Part of the pair's size by which two points that are one may miss each other.
constexpr double meeting_slack = 1e-10;
/// The same of the proof that a direction is one of nearest approach.
constexpr double proven = 1e-12;
/// Radian: how far edges and faces are tried where those within search_resolution did not lead to a peak.
constexpr double widest_angle = 0.6;

CommonPoint meeting_point(const ConvexCore& a, const ConvexCore& b, const Peak& peak) {
  const Vec3& n = peak.normal;
  thread_local ContactOutline of_a, of_b;
  const double scale = length_scale(a, b);
  CommonPoint best{};
  best.miss = std::numeric_limits<double>::infinity();
  // a normal that is off by rounding may leave out a corner of an edge or a face
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

/// Where the cores have no common point on the normal: the peak is narrow, or so flat that the next feature
/// is far.
void improve(const ConvexCore& a, const ConvexCore& b, Approach& found) {
  const auto take = [&](const Peak& other) {
    if (other.core_gap > found.peak.core_gap) found = meet(a, b, other);
  };
  // of cores that hardly touch, the points that were to meet tell the direction
  if (const Vec3 between = found.where.on_b - found.where.on_a; between.dot(found.peak.normal) > 0)
    take(climb(a, b, between.normalized(), search_resolution));
  take(climb(a, b, found.peak.normal, widest_angle));
  if (const auto apart = gjk_direction(a, b, Vec3::Zero(), found.peak.normal))
    take(climb(a, b, *apart, widest_angle));
}

/// Whether proven to be the largest separation; see proven_direction().
bool is_best(const ConvexCore& a, const ConvexCore& b, const Approach& found) {
  const double slack = proven * length_scale(a, b), gap = found.peak.core_gap + slack;
  if (!(found.where.miss <= slack)) return false;
  return gap >= 0 || is_least_depth(a, b, found.peak.normal, -gap, found.where);
}

/// From their least depth, which has no need of a proof.
Approach overlap(const ConvexCore& a, const ConvexCore& b, const Peak& least) {
  Approach found = meet(a, b, least);
  if (found.where.miss > proven * length_scale(a, b)) improve(a, b, found);
  return found;
}

/// Of two ellipsoids d apart: normal to the plane on which both have the same value of their quadratic forms
/// if these were one, (A + B)^-1 d.
Vec3 between_ellipsoids(const ConvexCore& a, const ConvexCore& b) {
  const auto form = [](const ConvexCore& c) -> Mat3 {
    return c.axes * c.half.cwiseAbs2().asDiagonal() * c.axes.transpose();
  };
  return ((form(a) + form(b)).inverse() * between_centres(a, b)).normalized();
}

/// Of polyhedra with more corners GJK finds the direction sooner than climb(), which tries many of their
/// faces.
bool has_few_corners(const ConvexCore& core) {
  constexpr std::size_t most = 48;
  const auto* const polyhedron = std::get_if<Polyhedron>(core.shape);
  return !polyhedron || polyhedron->mesh->vertices.size() <= most;
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

}  // namespace silt::rigid

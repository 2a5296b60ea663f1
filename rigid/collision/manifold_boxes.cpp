#include "rigid/collision/manifold.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "rigid/collision/outline.hpp"

namespace silt::rigid {
namespace {

/// Lengths below this, relative to the pair's size, are rounding.
constexpr double gap_rounding = 1e-10;
/// Sine of the largest angle at which capsules may touch along their common length,
constexpr double parallel_axes_sine = 0.2;
/// and the least cosine between the normals there and that of the nearest point (for deep overlaps).
constexpr double same_gap_cosine = 0.9;

ContactPoint contact(const Vec3& on_a, const Vec3& normal, double gap, const Feature& of_a,
                     const Feature& of_b) {
  return {on_a, on_a + gap * normal, normal, gap, feature_id(of_a, of_b)};
}

/// Returns the feature of a core nearest to x; for an x inside, the one in the direction `towards`.
Feature nearest_feature(const ConvexCore& core, const Vec3& x, const Vec3& towards, double slack) {
  const Vec3 local = core.direction_B(x - core.centre);
  Feature f;
  bool outside = false;
  for (int k = 0; k < 3; ++k) {
    if (core.half[k] <= 0 || std::abs(local[k]) < core.half[k] + slack) continue;
    f.sign[k] = local[k] < 0 ? -1 : 1;
    outside = true;
  }
  return outside || core.extent() < 3 ? f : face_towards(core, towards).feature;
}

struct OnSegment {
  double t;  // signed distance from the middle
  Feature feature;
};

OnSegment clamp_to(const ConvexCore& capsule, double t) {
  const double half = capsule.half.z();
  const double slack = gap_rounding * half;
  Feature f;
  if (t >= half - slack) f.sign[2] = 1;
  if (t <= -half + slack) f.sign[2] = -1;
  return {std::clamp(t, -half, half), f};
}

/// Returns the distance, along unit m, from a point on a capsule's segment, `t` from its middle, to the
/// surface: on the hemisphere of its end if m points away from the other end, else on the side; nothing if
/// that surface point is on the other hemisphere, which has its own point.
std::optional<double> to_surface(const ConvexCore& capsule, const OnSegment& at, const Vec3& m) {
  const double tilt = capsule.axes.col(2).dot(m);
  if (at.feature.sign[2] * tilt >= 0 && (at.feature.sign[2] != 0 || std::abs(tilt) < 1e-12))
    return capsule.radius;
  const double across = std::sqrt(std::max(0.0, 1 - tilt * tilt));
  if (std::abs(at.t * across + capsule.radius * tilt) > capsule.half.z() * across) return {};
  return capsule.radius / across;
}

/// The contact of two spheres, or of a sphere and any other core.
void sphere_point(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double core_gap,
                  std::vector<ContactPoint>& points) {
  const double gap = core_gap - a.radius - b.radius;
  if (a.extent() == 0) {
    points.push_back(contact(a.centre + a.radius * n, n, gap, {}, nearest_feature(b, a.centre, -n, 0)));
  } else {
    const Vec3 on_a = b.centre - (core_gap - a.radius) * n;
    points.push_back(contact(on_a, n, gap, nearest_feature(a, b.centre, n, 0), {}));
  }
}

/// Adds the contact of point t of a's segment with b's, as of two spheres, unless it is beyond the end of b.
void end_over(const ConvexCore& a, const OnSegment& end, const ConvexCore& b, const Vec3& n, bool swap,
              std::vector<ContactPoint>& points) {
  const Vec3 x = a.centre + end.t * a.axes.col(2);
  const double t = (x - b.centre).dot(b.axes.col(2));
  if (std::abs(t) > b.half.z() * (1 + gap_rounding)) return;
  const OnSegment other = clamp_to(b, t);
  const Vec3 between = b.centre + other.t * b.axes.col(2) - x;
  const double distance = between.norm();
  const Vec3 normal =
      distance > 1e-6 * (a.radius + b.radius) ? Vec3(between / distance) : Vec3(swap ? -n : n);
  const auto of_a = to_surface(a, end, normal), of_b = to_surface(b, other, -normal);
  if (!of_a || !of_b || normal.dot(swap ? -n : n) < same_gap_cosine) return;
  const double gap = between.dot(normal) - *of_a - *of_b;
  if (!swap)
    add_unique(points, contact(x + *of_a * normal, normal, gap, end.feature, other.feature));
  else
    add_unique(points, contact(x + (*of_a + gap) * normal, -normal, gap, other.feature, end.feature));
}

void capsule_points(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double core_gap,
                    std::vector<ContactPoint>& points) {
  const Vec3 u = a.axes.col(2), v = b.axes.col(2);
  const double sine = u.cross(v).norm();
  if (sine <= parallel_axes_sine) {
    for (const double sign : {-1.0, 1.0}) {
      end_over(a, clamp_to(a, sign * a.half.z()), b, n, false, points);
      end_over(b, clamp_to(b, sign * b.half.z()), a, n, true, points);
    }
  }
  // the closest points of the lines, clamped in turn, which is exact for segments
  const double gap = core_gap - a.radius - b.radius;
  for (const ContactPoint& p : points)
    if (p.gap <= gap + gap_rounding * length_scale(a, b)) return;
  const Vec3 d = b.centre - a.centre;
  const double cosine = u.dot(v), det = sine * sine;
  auto nearest_on_b = [&](double s) { return (s * u - d).dot(v); };
  auto nearest_on_a = [&](double t) { return (t * v + d).dot(u); };
  double s = det > 1e-20 ? (d.dot(u) - cosine * d.dot(v)) / det : 0;
  OnSegment on_a = clamp_to(a, s), on_b = clamp_to(b, nearest_on_b(on_a.t));
  on_a = clamp_to(a, nearest_on_a(on_b.t));
  on_b = clamp_to(b, nearest_on_b(on_a.t));
  const Vec3 x = a.centre + on_a.t * u;
  add_unique(points, contact(x + a.radius * n, n, gap, on_a.feature, on_b.feature));
}

/// Adds the points of a capsule over a box's face; `m` is the unit vector from the capsule to the box.
void capsule_on_box(const ConvexCore& capsule, const ConvexCore& box, const Vec3& m, bool swap, double slack,
                    std::vector<ContactPoint>& points) {
  const BoxFace face = face_towards(box, -m);
  const FacePrism prism = prism_over(face, m);
  const auto over = clip_segment(prism, capsule.vertex(Vec3(0, 0, -1)), capsule.vertex(Vec3(0, 0, 1)), slack);
  for (int e = 0; e < 2 && over; ++e) {
    const Vec3& end = over->end[e];
    const Feature of_capsule{{0, 0, std::int8_t(over->is_cut[e] ? 0 : 2 * e - 1)}},
        of_box = feature_under(face, prism, end, 10 * slack);
    const double t = (end - capsule.centre).dot(capsule.axes.col(2));
    const auto offset = to_surface(capsule, {t, of_capsule}, m);
    if (!offset) continue;
    const Vec3 surface = end + *offset * m;
    const double gap = face.height(surface, m);
    if (!swap)
      add_unique(points, contact(surface, m, gap, of_capsule, of_box));
    else
      add_unique(points, contact(surface + gap * m, -m, gap, of_box, of_capsule));
  }
}

void box_points(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double slack,
                std::vector<ContactPoint>& points) {
  const BoxFace face_a = face_towards(a, n), face_b = face_towards(b, -n);
  const FacePrism over_a = prism_over(face_a, n), over_b = prism_over(face_b, n);
  BoxPolygon patch;
  for (const Vec3& x : face_b.corner) patch.push_back(x);
  clip(over_a, slack, patch);
  for (std::size_t c = 0; c < patch.size(); ++c) {
    const Vec3& x = patch[c];
    const double gap = -face_a.height(x, n);
    // by position, since rounding decides which edges the clipping has passed through at a vertex
    const Feature of_a = feature_under(face_a, over_a, x, 10 * slack);
    const Feature of_b = feature_under(face_b, over_b, x, 10 * slack);
    add_unique(points, {x - gap * n, x, n, gap, feature_id(of_a, of_b)});
  }
}

/// The last resort if an inexact normal leaves no point over any feature (an edge along an edge): adds, of
/// the touching vertices of either body, the one whose partner point is closest to the other core.
void add_deepest(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double core_gap,
                 std::vector<ContactPoint>& points) {
  constexpr double touching = 1e-6;  // relative to the pair's size
  const double slack = touching * length_scale(a, b), gap = core_gap - a.radius - b.radius;
  double least = std::numeric_limits<double>::infinity();
  ContactPoint best{};
  a.for_each_vertex([&](const Feature& f) {
    const Vec3 x = a.vertex(f), partner = x + core_gap * n;
    const double miss = b.outside(partner).norm();
    if (n.dot(x - a.centre) < a.reach(n) - slack || miss >= least) return;
    least = miss;
    best = contact(x + a.radius * n, n, gap, f, nearest_feature(b, partner, -n, -slack));
  });
  b.for_each_vertex([&](const Feature& f) {
    const Vec3 x = b.vertex(f), partner = x - core_gap * n;
    const double miss = a.outside(partner).norm();
    if (n.dot(x - b.centre) > slack - b.reach(n) || miss >= least) return;
    least = miss;
    best = contact(partner + a.radius * n, n, gap, nearest_feature(a, partner, n, -slack), f);
  });
  add_unique(points, best);
}

}  // namespace

void append_box_manifold(const ConvexCore& a, const ConvexCore& b, const Peak& peak, double tolerance,
                         std::vector<ContactPoint>& out) {
  const auto& [normal, core_gap] = peak;
  if (core_gap - a.radius - b.radius > tolerance) return;
  const int extent_a = a.extent(), extent_b = b.extent();
  if (extent_a == 0 || extent_b == 0) return sphere_point(a, b, normal, core_gap, out);
  thread_local std::vector<ContactPoint> points;
  const double gap = core_gap - a.radius - b.radius, scale = length_scale(a, b);
  const auto is_deepest = [&](const ContactPoint& p) {
    return std::abs(p.gap - gap) <= 10 * gap_rounding * scale;
  };
  // for an edge along an edge, rounding or the error of the normal decides what is over what; the deepest
  // point must be kept, and no point can lie between the supporting planes
  bool has_deepest = false;
  for (const double slack : {gap_rounding * scale, 100 * gap_rounding * scale}) {
    points.clear();
    if (extent_a == 1 && extent_b == 1)
      capsule_points(a, b, normal, core_gap, points);
    else if (extent_a == 1)
      capsule_on_box(a, b, normal, false, slack, points);
    else if (extent_b == 1)
      capsule_on_box(b, a, -normal, true, slack, points);
    else
      box_points(a, b, normal, slack, points);
    std::erase_if(points, [&](const ContactPoint& p) { return p.gap < gap && !is_deepest(p); });
    has_deepest = std::ranges::any_of(points, is_deepest);
    if (has_deepest) break;
  }
  if (!has_deepest) add_deepest(a, b, normal, core_gap, points);
  std::erase_if(points, [&](const ContactPoint& p) { return p.gap > tolerance; });
  std::sort(points.begin(), points.end(),
            [](const ContactPoint& p, const ContactPoint& q) { return p.feature < q.feature; });
  out.insert(out.end(), points.begin(), points.end());
}

void append_box_plane_manifold(const ConvexCore& a, const Vec3& origin, const Vec3& outward, double tolerance,
                               std::vector<ContactPoint>& out) {
  const Vec3 normal = -outward;
  const bool capsule = a.extent() == 1;
  a.for_each_vertex([&](const Feature& f) {
    const auto offset = capsule ? to_surface(a, {f.sign[2] * a.half.z(), f}, normal) : a.radius;
    if (!offset) return;
    const Vec3 on_a = a.vertex(f) + *offset * normal;
    const double gap = outward.dot(on_a - origin);
    if (gap <= tolerance) out.push_back(contact(on_a, normal, gap, f, {}));
  });
}

}  // namespace silt::rigid

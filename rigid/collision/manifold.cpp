#include "rigid/collision/manifold.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "rigid/collision/outline.hpp"

namespace silt::rigid {
namespace {

constexpr double length_rounding = 1e-12;  // relative to the pair's size: smaller lengths are rounding
constexpr double same_depth = 2e-14;  // relative to the pair's size: smaller differences of gaps are rounding
/// Cosine between normals below which a face is too oblique for contact points.
constexpr double oblique_cosine = 0.1;
/// Sine of the largest angle at which lines (of capsules and cylinders) may touch along their common length,
constexpr double parallel_lines_sine = 0.2;
/// and the least cosine between their surfaces' normals there and the normal of the deepest point.
constexpr double same_side_cosine = 0.9;

std::uint32_t pair_code(std::uint32_t of_a, std::uint32_t of_b) {
  return of_a << 16 | of_b;
}

/// Collects contact points given as on the first and second body, which are b and a if `swap`.
struct PointList {
  std::vector<ContactPoint>& points;
  bool swap;

  void add(const Vec3& on_first, const Vec3& m, double gap, std::uint32_t first, std::uint32_t second) const {
    const Vec3 on_second = on_first + gap * m;
    if (!swap)
      add_unique(points, {on_first, on_second, m, gap, pair_code(first, second)});
    else
      add_unique(points, {on_second, on_first, -m, gap, pair_code(second, first)});
  }
};

void face_on_face(const ContactOutline& a, const ContactOutline& b, const Vec3& n, double slack,
                  std::vector<ContactPoint>& points) {
  if (a.normal.dot(n) < oblique_cosine || -b.normal.dot(n) < oblique_cosine) return;
  const Prism over_a(a, n), over_b(b, n);
  std::vector<Vec3> patch;
  for (const auto& corner : b.corners) patch.push_back(corner.x);
  clip(over_a, slack, patch);
  for (const Vec3& x : patch) {
    const double gap = -a.height(x, n);
    const std::uint32_t of_a = code_under(a, over_a, x, 10 * slack),
                        of_b = code_under(b, over_b, x, 10 * slack);
    add_unique(points, {x - gap * n, x, n, gap, pair_code(of_a, of_b)});
  }
}

/// Returns the distance, along unit m, from a point on a swept segment's axis, `t` from its middle, to the
/// surface; nothing if that surface point is beyond the barrel but not on a hemisphere (which has its own
/// point). The line of a cylinder is already on the surface.
std::optional<double> to_surface(const ConvexCore& line, double t, const Vec3& m) {
  if (line.radius == 0) return 0;
  const double half = line.half.z(), tilt = line.axes.col(2).dot(m);
  const bool at_end = std::abs(t) >= half * (1 - length_rounding);
  if (at_end ? t * tilt >= 0 : std::abs(tilt) < 1e-12) return line.radius;
  const double across = std::sqrt(std::max(0.0, 1 - tilt * tilt));
  if (std::abs(t * across + line.radius * tilt) > half * across) return {};
  return line.radius / across;
}

void line_on_face(const ConvexCore& core, const ContactOutline& line, const ContactOutline& face,
                  const Vec3& m, double slack, const PointList& points) {
  if (-face.normal.dot(m) < oblique_cosine) return;
  const Prism prism(face, m);
  const auto over = clip_segment(prism, line.corners[0].x, line.corners[1].x, slack);
  for (int e = 0; e < 2 && over; ++e) {
    const Vec3& end = over->end[e];
    const auto offset = to_surface(core, (end - core.centre).dot(core.axes.col(2)), m);
    if (!offset) continue;
    const Vec3 surface = end + *offset * m;
    // where both ends are cut the features of the face distinguish them
    points.add(surface, m, face.height(surface, m), over->is_cut[e] ? line.code : line.corners[e].code,
               code_under(face, prism, end, 10 * slack));
  }
}

/// Returns the radius of the round surface of a line about the third axis; 0 if none.
double barrel_radius(const ConvexCore& core, const ContactOutline& line) {
  return line.barrel_radius > 0 ? line.barrel_radius : core.radius;
}

/// Adds the points at the ends of a's barrel, along its normals there to the barrel of b.
void ends_over_barrel(const ConvexCore& a, const ContactOutline& line_a, const ConvexCore& b,
                      const ContactOutline& line_b, const Vec3& n, const PointList& points) {
  const Vec3 u = a.axes.col(2), v = b.axes.col(2);
  const Vec3 m = (n - n.dot(u) * u).normalized();
  if (!(m.dot(n) >= same_side_cosine)) return;
  for (int e = 0; e < 2; ++e) {
    const Vec3 x = a.centre + (e ? 1 : -1) * a.half.z() * u + barrel_radius(a, line_a) * m;
    // |across(x + gap m - b)| = radius of b, the nearer of the two solutions
    const Vec3 d = x - b.centre, d_across = d - d.dot(v) * v, m_across = m - m.dot(v) * v;
    const double q = m_across.squaredNorm(), p = d_across.dot(m_across) / q;
    const double r = barrel_radius(b, line_b), root = p * p - (d_across.squaredNorm() - r * r) / q;
    if (!(root >= 0)) continue;
    const double gap = -p - std::sqrt(root), t = (d + gap * m).dot(v), half = b.half.z();
    if (std::abs(t) > half * (1 + length_rounding)) continue;
    const std::uint32_t code_b =
        std::abs(t) < half * (1 - length_rounding) ? line_b.code : line_b.corners[t > 0].code;
    points.add(x, m, gap, line_a.corners[e].code, code_b);
  }
}

void line_on_line(const ConvexCore& a, const ContactOutline& line_a, const ConvexCore& b,
                  const ContactOutline& line_b, const Vec3& n, std::vector<ContactPoint>& points) {
  if (!(barrel_radius(a, line_a) > 0 && barrel_radius(b, line_b) > 0)) return;
  if (a.axes.col(2).cross(b.axes.col(2)).norm() > parallel_lines_sine) return;
  ends_over_barrel(a, line_a, b, line_b, n, {points, false});
  ends_over_barrel(b, line_b, a, line_a, -n, {points, true});
}

void flat_points(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double slack,
                 std::vector<ContactPoint>& points) {
  thread_local ContactOutline of_a, of_b;
  a.facing_outline(n, of_a);
  b.facing_outline(-n, of_b);
  if (of_a.is_face() && of_b.is_face())
    face_on_face(of_a, of_b, n, slack, points);
  else if (of_a.size() == 2 && of_b.is_face())
    line_on_face(a, of_a, of_b, n, slack, {points, false});
  else if (of_b.size() == 2 && of_a.is_face())
    line_on_face(b, of_b, of_a, -n, slack, {points, true});
  else if (of_a.size() == 2 && of_b.size() == 2)
    line_on_line(a, of_a, b, of_b, n, points);
}

}  // namespace

void append_manifold(const ConvexCore& a, const ConvexCore& b, const Approach& approach, double tolerance,
                     std::vector<ContactPoint>& out) {
  if (a.is_box && b.is_box) return append_box_manifold(a, b, approach.peak, tolerance, out);
  const auto& [n, core_gap] = approach.peak;
  const CommonPoint& deepest = approach.where;
  const double gap = core_gap - a.radius - b.radius, scale = length_scale(a, b);
  const double slack = length_rounding * scale, deep = same_depth * scale;
  if (gap > tolerance) return;
  thread_local std::vector<ContactPoint> points;
  points.clear();
  flat_points(a, b, n, slack, points);
  // no point can lie between the supporting planes
  std::erase_if(points, [&](const ContactPoint& p) { return p.gap < gap - slack || p.gap > tolerance; });
  const bool has_deepest =
      std::ranges::any_of(points, [&](const ContactPoint& p) { return p.gap <= gap + deep; });
  if (!has_deepest) {
    const Vec3 on_a = deepest.on_a + a.radius * n;
    add_unique(points, {on_a, on_a + gap * n, n, gap, pair_code(deepest.code_a, deepest.code_b)});
  }
  std::sort(points.begin(), points.end(),
            [](const ContactPoint& p, const ContactPoint& q) { return p.feature < q.feature; });
  out.insert(out.end(), points.begin(), points.end());
}

void append_plane_manifold(const ConvexCore& a, const Vec3& origin, const Vec3& outward, double tolerance,
                           std::vector<ContactPoint>& out) {
  if (a.is_box) return append_box_plane_manifold(a, origin, outward, tolerance, out);
  const Vec3 n = -outward;
  thread_local std::vector<PlanePoint> points;
  points.clear();
  a.plane_points(n, points);
  const auto gap_of = [&](const PlanePoint& p) { return outward.dot(p.x - origin); };
  double lowest_fixed = std::numeric_limits<double>::infinity();
  for (const PlanePoint& p : points)
    if (!p.only_if_lowest) lowest_fixed = std::min(lowest_fixed, gap_of(p));
  for (const PlanePoint& p : points) {
    if (p.only_if_lowest && gap_of(p) >= lowest_fixed - same_depth * a.half.norm()) continue;
    const double gap = gap_of(p) - a.radius;
    const Vec3 on_a = p.x + a.radius * n;
    if (gap <= tolerance) out.push_back({on_a, on_a + gap * n, n, gap, pair_code(p.code, 0)});
  }
}

void add_unique(std::vector<ContactPoint>& points, const ContactPoint& p) {
  for (ContactPoint& q : points)
    if (q.feature == p.feature) {
      if (p.gap < q.gap) q = p;
      return;
    }
  points.push_back(p);
}

void reduce_manifold(std::vector<ContactPoint>& points) {
  if (points.size() <= most_contact_points) return;
  std::vector<double> apart(points.size(),
                            std::numeric_limits<double>::infinity());  // squared, to the points kept
  std::vector<char> kept(points.size(), 0);
  std::size_t next =
      std::ranges::min_element(points, [](const auto& p, const auto& q) { return p.gap < q.gap; }) -
      points.begin();
  for (std::size_t count = 0; count < most_contact_points; ++count) {
    kept[next] = 1;
    for (std::size_t k = 0; k < points.size(); ++k)
      apart[k] = std::min(apart[k], (points[k].on_a - points[next].on_a).squaredNorm());
    next = std::ranges::max_element(apart) - apart.begin();
  }
  std::size_t k = 0;
  std::erase_if(points, [&](const ContactPoint&) { return !kept[k++]; });
}

}  // namespace silt::rigid

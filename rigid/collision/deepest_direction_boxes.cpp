#include "rigid/collision/deepest_direction.hpp"

#include <algorithm>
#include <cmath>

namespace silt::rigid {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Differences below this, relative to the pair's size, are rounding.
constexpr double difference_rounding = 1e-13;
/// Sine of the angle below which edges count as parallel: their common normal is no better than a face's.
constexpr double parallel_edges_sine = 1e-8;

/// Returns the unit axis with the sign that points from a to b.
Vec3 oriented(const Vec3& axis, const Vec3& d) {
  return axis.dot(d) < 0 ? Vec3(-axis) : axis;
}

/// Returns the common normal of the edges along axis i of a and j of b; nothing if they are parallel.
std::optional<Vec3> crossed_edges(const ConvexCore& a, int i, const ConvexCore& b, int j) {
  if (a.half[i] <= 0 || b.half[j] <= 0) return {};
  const Vec3 cross = a.axes.col(i).cross(b.axes.col(j));
  const double sine = cross.norm();
  if (sine < parallel_edges_sine) return {};
  return oriented(cross / sine, b.centre - a.centre);
}

/// Calls use(unit axis from a to b, whether of two crossed edges) for the Minkowski difference's normals.
template <class Use>
void for_each_candidate(const ConvexCore& a, const ConvexCore& b, Use use) {
  const Vec3 d = b.centre - a.centre;
  for (const ConvexCore* box : {&a, &b})
    if (box->extent() == 3)
      for (int i = 0; i < 3; ++i) use(oriented(box->axes.col(i), d), false);
  if (!a.extent() || !b.extent()) return;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (const auto n = crossed_edges(a, i, b, j)) use(*n, true);
}

/// Computes the separations along all candidates from one table of cosines in a's axes (Gottschalk, Lin,
/// Manocha, SIGGRAPH 1996, section 5).
struct AxisTable {
  const ConvexCore &a, &b;
  Vec3 d, d_a, d_b;     // from a to b: in the query's frame, in the axes of a and of b
  Mat3 cosine, extent;  // of axis i of a with axis j of b, and its absolute value

  AxisTable(const ConvexCore& first, const ConvexCore& second)
      : a(first),
        b(second),
        d(b.centre - a.centre),
        d_a(a.axes.transpose() * d),
        d_b(b.axes.transpose() * d),
        cosine(a.axes.transpose() * b.axes),
        extent(cosine.cwiseAbs()) {}

  double of_face_a(int i) const { return std::abs(d_a[i]) - a.half[i] - extent.row(i).dot(b.half); }
  double of_face_b(int j) const { return std::abs(d_b[j]) - b.half[j] - extent.col(j).dot(a.half); }
  /// Returns minus infinity if an axis has no edge, the edges are parallel, or they cannot exceed `best`.
  double of_edges(int i, int j, double best) const {
    if (a.half[i] <= 0 || b.half[j] <= 0) return -infinity;
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
    const double centres = std::abs(d_a[i2] * cosine(i1, j) - d_a[i1] * cosine(i2, j));
    const double reach_a = a.half[i1] * extent(i2, j) + a.half[i2] * extent(i1, j);
    const double reach_b = b.half[j1] * extent(i, j2) + b.half[j2] * extent(i, j1);
    const double gap_by_sine = centres - reach_a - reach_b;
    if (gap_by_sine <= std::min(best, 0.0)) return -infinity;
    const double sine = std::sqrt(cosine(i1, j) * cosine(i1, j) + cosine(i2, j) * cosine(i2, j));
    return sine < parallel_edges_sine ? -infinity : gap_by_sine / sine;
  }
};

/// From a point to a box; the normal has exactly zero components along the nearest edge or face.
Peak point_to_core(const Vec3& x, const ConvexCore& core) {
  const Vec3 outside = core.outside(x);
  const double distance = outside.norm();
  if (distance == 0) return {Vec3::Zero(), 0};
  return {core.axes * (outside / distance), distance};
}

/// Returns the vertex of `core` nearest to `other`, with the normal from `other` to `core`.
Peak nearest_vertex(const ConvexCore& core, const ConvexCore& other) {
  Peak best{Vec3::Zero(), infinity};
  core.for_each_vertex([&](const Feature& f) {
    const Peak s = point_to_core(core.vertex(f), other);
    if (s.core_gap < best.core_gap) best = s;
  });
  return best;
}

/// Returns whether the edges that support n, along axis i of a and j of b, cross as seen along n.
bool edges_cross(const ConvexCore& a, int i, const ConvexCore& b, int j, const Vec3& n) {
  Vec3 mid_a = a.centre, mid_b = b.centre;
  for (int k = 0; k < 3; ++k) {
    if (k != i) mid_a += (a.axes.col(k).dot(n) < 0 ? -a.half[k] : a.half[k]) * a.axes.col(k);
    if (k != j) mid_b += (b.axes.col(k).dot(n) < 0 ? b.half[k] : -b.half[k]) * b.axes.col(k);
  }
  const Vec3 u = a.axes.col(i), v = b.axes.col(j), d = mid_b - mid_a;
  const double cosine = u.dot(v), det = 1 - cosine * cosine;
  const double s = (d.dot(u) - cosine * d.dot(v)) / det, t = (cosine * d.dot(u) - d.dot(v)) / det;
  return std::abs(s) <= a.half[i] && std::abs(t) <= b.half[j];
}

/// Returns the exact distance of cores that do not overlap.
Peak closest_features(const ConvexCore& a, const ConvexCore& b) {
  Peak best = nearest_vertex(b, a);
  const Peak of_a = nearest_vertex(a, b);
  if (of_a.core_gap < best.core_gap) best = {-of_a.normal, of_a.core_gap};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (const auto n = crossed_edges(a, i, b, j)) {
        const double gap = box_separation(a, b, *n);
        if (gap >= 0 && gap < best.core_gap && edges_cross(a, i, b, j, *n)) best = {*n, gap};
      }
  return best;
}

/// Returns whether the vertex of `core` nearest to `other` along n, a face normal of `other`, projects onto
/// that face: then it realises the distance of the cores.
bool vertex_over_face(const ConvexCore& core, const ConvexCore& other, const Vec3& n) {
  const Vec3 along = core.axes.transpose() * n;
  const Vec3 nearest(along.x() > 0 ? -1 : 1, along.y() > 0 ? -1 : 1, along.z() > 0 ? -1 : 1);
  return (other.outside(core.vertex(nearest)).array() != 0).count() == 1;
}

/// Returns whether the axis of two separated cores is known to be that of their distance.
bool is_distance(const ConvexCore& a, const ConvexCore& b, const Vec3& axis) {
  const auto face_of = [&](const ConvexCore& core) {
    return core.extent() == 3 && (core.axes.transpose() * axis).cwiseAbs().maxCoeff() > 1 - 1e-15;
  };
  return (face_of(a) && vertex_over_face(b, a, axis)) || (face_of(b) && vertex_over_face(a, b, -axis));
}

/// Handles touching cores without volume: coinciding points, segments that cross or are collinear.
Peak touching_cores(const ConvexCore& a, const ConvexCore& b) {
  if (const auto n = crossed_edges(a, 2, b, 2)) return {*n, 0};
  const ConvexCore& line = a.extent() ? a : b;
  const Vec3 d = b.centre - a.centre;
  // an arbitrary unit vector, always the same
  return {line.extent() ? oriented(line.axes.col(0), d) : Vec3::UnitZ(), 0};
}

}  // namespace

Peak best_separating_axis(const ConvexCore& a, const ConvexCore& b, double enough) {
  const AxisTable table(a, b);
  const double edge_handicap =
      10 * difference_rounding * length_scale(a, b);  // of two equal axes the face normal is kept
  double best = -infinity;
  Vec3 axis = Vec3::UnitZ();
  const auto found = [&] { return Peak{axis, best > -infinity ? box_separation(a, b, axis) : best}; };
  if (a.extent() == 3)
    for (int i = 0; i < 3; ++i)
      if (const double gap = table.of_face_a(i); gap > best)
        if (best = gap, axis = oriented(a.axes.col(i), table.d); gap > enough) return found();
  if (b.extent() == 3)
    for (int j = 0; j < 3; ++j)
      if (const double gap = table.of_face_b(j); gap > best)
        if (best = gap, axis = oriented(b.axes.col(j), table.d); gap > enough) return found();
  int edge_a = -1, edge_b = -1;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (const double gap = table.of_edges(i, j, best) - edge_handicap; gap > best)
        best = gap, edge_a = i, edge_b = j;
  if (edge_a >= 0) axis = *crossed_edges(a, edge_a, b, edge_b);
  return found();
}

Vec3 nearest_candidate_axis(const ConvexCore& a, const ConvexCore& b, const Vec3& n, double angle) {
  Vec3 nearest = n;
  double least = angle * angle;
  for_each_candidate(a, b, [&](const Vec3& axis, bool) {
    const Vec3 towards = axis.dot(n) < 0 ? Vec3(-axis) : axis;
    const double distance = (towards - n).squaredNorm();
    if (distance >= least) return;
    least = distance;
    nearest = towards;
  });
  return nearest;
}

std::optional<Peak> deepest_separation(const ConvexCore& a, const ConvexCore& b, double tolerance) {
  const int extent_a = a.extent(), extent_b = b.extent();
  const double reach = std::max(tolerance + a.radius + b.radius, 0.0), scale = length_scale(a, b);
  if (extent_a == 0 || extent_b == 0) {  // a point and a box, a segment, a point
    const bool a_is_point = extent_a == 0;
    Peak s = a_is_point ? point_to_core(a.centre, b) : point_to_core(b.centre, a);
    if (s.core_gap > reach) return {};
    if (a_is_point) s.normal = -s.normal;
    if (s.core_gap > difference_rounding * scale) return s;
    return extent_a + extent_b == 3 ? best_separating_axis(a, b) : touching_cores(a, b);
  }
  const Peak axis = best_separating_axis(a, b, reach);
  if (axis.core_gap > reach) return {};
  const bool with_box = extent_a == 3 || extent_b == 3;
  if (with_box && axis.core_gap <= 0) return axis;
  if (axis.core_gap > difference_rounding * scale && is_distance(a, b, axis.normal)) return axis;
  const Peak closest = closest_features(a, b);
  if (closest.core_gap <= difference_rounding * scale) return with_box ? axis : touching_cores(a, b);
  // The normal of larger separation is correct: for parallel faces with no vertex over either (crossed
  // beams), the features found are not the closest, and only the axis gives the distance.
  const Peak best = box_separation(a, b, closest.normal) > axis.core_gap ? closest : axis;
  if (best.core_gap > reach) return {};
  return best;
}

}  // namespace silt::rigid

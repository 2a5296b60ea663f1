#include "tests/adapters/pair_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace silt::tests {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double radius_of(const ConvexShape& shape) {
  if (const auto* s = std::get_if<rigid::Sphere>(&shape)) return s->radius;
  if (const auto* c = std::get_if<rigid::Capsule>(&shape)) return c->radius;
  return 0;
}

/// A sphere, capsule or box.
bool swept(const ConvexShape& shape) {
  return std::holds_alternative<rigid::Sphere>(shape) || std::holds_alternative<rigid::Capsule>(shape) ||
         std::holds_alternative<rigid::Box>(shape);
}

/// Vertices of the shape less its radius.
std::vector<Vec3> core_vertices(const ConvexShape& shape, const Pose& pose) {
  std::vector<Vec3> vertices;
  if (const auto* b = std::get_if<rigid::Box>(&shape)) {
    for (int v = 0; v < 8; ++v)
      vertices.push_back(pose.to_world({v & 1 ? b->half_edges[0] : -b->half_edges[0],
                                        v & 2 ? b->half_edges[1] : -b->half_edges[1],
                                        v & 4 ? b->half_edges[2] : -b->half_edges[2]}));
  } else if (const auto* c = std::get_if<rigid::Capsule>(&shape)) {
    vertices = {pose.to_world({0, 0, -c->half_length}), pose.to_world({0, 0, c->half_length})};
  } else {
    vertices = {pose.position};
  }
  return vertices;
}

Vec3 nearest_on_edge(const Vec3& p, const Vec3& q) {
  const Vec3 along = q - p;
  const double l2 = along.squaredNorm();
  const double t = l2 > 0 ? std::clamp(-p.dot(along) / l2, 0.0, 1.0) : 0;
  return p + t * along;
}

/// The point of a triangle nearest to the origin.
Vec3 nearest_on_triangle(const Vec3& p, const Vec3& q, const Vec3& r) {
  const Vec3 normal = (q - p).cross(r - p);
  if (normal.squaredNorm() > 1e-16) {
    const Vec3 foot = normal * (p.dot(normal) / normal.squaredNorm());
    if (normal.dot((q - p).cross(foot - p)) >= 0 && normal.dot((r - q).cross(foot - q)) >= 0 &&
        normal.dot((p - r).cross(foot - r)) >= 0)
      return foot;
  }
  Vec3 best = nearest_on_edge(p, q);
  for (const Vec3& other : {nearest_on_edge(q, r), nearest_on_edge(r, p)})
    if (other.squaredNorm() < best.squaredNorm()) best = other;
  return best;
}

/// Returns, for the hull of the points, the nearest plane through three of them with all on its inner side
/// (depth of the origin, as an inward normal); nothing (infinite) where the origin is outside or the hull is
/// flat.
ReferenceGap depth_in_hull(const std::vector<Vec3>& w) {
  ReferenceGap best{-infinity, Vec3::Zero()};
  const std::size_t n = w.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      for (std::size_t k = j + 1; k < n; ++k) {
        Vec3 m = (w[j] - w[i]).cross(w[k] - w[i]);
        const double length = m.norm();
        if (length < 1e-9) continue;
        m /= length;
        double low = infinity, high = -infinity;
        for (const Vec3& x : w) {
          const double h = m.dot(x - w[i]);
          low = std::min(low, h);
          high = std::max(high, h);
          if (low < -1e-9 && high > 1e-9) break;
        }
        if (low < -1e-9 && high > 1e-9) continue;
        if (low < -1e-9) m = -m;  // all on the side m points to
        const double separation = m.dot(w[i]);
        if (separation > best.gap) best = {separation, m};
      }
  return best;
}

}  // namespace

Quat random_orientation(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
}

ConvexShape random_shape(Kind kind, std::mt19937_64& random) {
  if (kind == half_space) return rigid::HalfSpace{random_direction(random)};
  return row_of(kind).random(Sizes(random));
}

double support_gap(const Pair& p, const Vec3& n) {
  auto support = [](const ConvexShape& shape, const Pose& pose, const Vec3& d) {
    return pose.to_world(rigid::support(shape, pose.orientation.conjugate() * d));
  };
  const double of_a = n.dot(support(p.a, p.pose_a, n));
  if (const auto* wall = std::get_if<rigid::HalfSpace>(&p.b)) {
    const Vec3 outward = p.pose_b.orientation * wall->normal;
    return (n + outward).norm() > 1e-9 ? -infinity : -outward.dot(p.pose_b.position) - of_a;
  }
  return n.dot(support(p.b, p.pose_b, -n)) - of_a;
}

ReferenceGap reference_gap(const Pair& p) {
  if (!swept(p.a) || !(swept(p.b) || std::holds_alternative<rigid::HalfSpace>(p.b))) return search_gap(p);
  const double radii = radius_of(p.a) + radius_of(p.b);
  if (const auto* wall = std::get_if<rigid::HalfSpace>(&p.b)) {
    const Vec3 outward = p.pose_b.orientation * wall->normal;
    double lowest = infinity;
    for (const Vec3& v : core_vertices(p.a, p.pose_a))
      lowest = std::min(lowest, outward.dot(v - p.pose_b.position));
    return {lowest - radii, -outward};
  }
  std::vector<Vec3> w;
  for (const Vec3& va : core_vertices(p.a, p.pose_a))
    for (const Vec3& vb : core_vertices(p.b, p.pose_b)) w.push_back(vb - va);
  if (w.size() > 4) {  // a solid hull: one of the shapes is a box
    const ReferenceGap depth = depth_in_hull(w);
    if (depth.gap <= 0) return {depth.gap - radii, depth.normal};
  }
  Vec3 nearest = w[0];
  for (std::size_t i = 0; i < w.size(); ++i)
    for (std::size_t j = i; j < w.size(); ++j)
      for (std::size_t k = j; k < w.size(); ++k) {
        const Vec3 x = nearest_on_triangle(w[i], w[j], w[k]);
        if (x.squaredNorm() < nearest.squaredNorm()) nearest = x;
      }
  const double distance = nearest.norm();
  return {distance - radii, distance > 0 ? Vec3(nearest / distance) : Vec3::UnitZ()};
}

Pair random_pair(Kind kind_a, Kind kind_b, double gap, std::mt19937_64& random) {
  Pair p{random_shape(kind_a, random), random_shape(kind_b, random), {}, {}};
  p.pose_a = {random_direction(random), random_orientation(random)};
  p.pose_b = {Vec3::Zero(), random_orientation(random)};
  Vec3 along = random_direction(random);
  if (const auto* wall = std::get_if<rigid::HalfSpace>(&p.b)) along = -(p.pose_b.orientation * wall->normal);
  const Vec3 sideways = random_direction(random);
  if (!has_closed_form(kind_a, kind_b)) {
    // apart, then along the normal
    p.pose_b.position = p.pose_a.position + sideways + 80 * along;
    for (int round = 0; round < 2; ++round) {
      const ReferenceGap far = reference_gap(p);
      p.pose_b.position += (gap - far.gap) * far.normal;
      if (std::holds_alternative<rigid::HalfSpace>(p.b) || gap < 0) break;
    }
    return p;
  }
  // a secant search: the gap grows along a ray out of a, steadily once the shapes are nearly apart
  double inner = 0, outer = 120;
  auto gap_at = [&](double t) {
    p.pose_b.position = p.pose_a.position + sideways + t * along;
    return reference_gap(p).gap - gap;
  };
  if (gap_at(inner) > 0) return random_pair(kind_a, kind_b, gap, random);
  double f_inner = gap_at(inner), f_outer = gap_at(outer);
  for (int step = 0; step < 100 && outer - inner > 1e-14 * outer; ++step) {
    // regula falsi, halving every third step
    double t =
        step % 3 == 2 ? 0.5 * (inner + outer) : inner - f_inner * (outer - inner) / (f_outer - f_inner);
    t = std::clamp(t, inner, outer);
    const double f = gap_at(t);
    if (std::abs(f) < 1e-13) break;
    (f < 0 ? inner : outer) = t;
    (f < 0 ? f_inner : f_outer) = f;
  }
  return p;
}

}  // namespace silt::tests

#pragma once
// Edges of bodies as they are defined, for tests of what object mapping does there: curves in space, none of
// the formulas of the kernels.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "rigid/shapes/shape.hpp"

namespace silt::coupler::testing {

using rigid::Vec3;

/// A straight edge; the share of a lip that it gets.
struct Edge {
  Vec3 from, to;
  double share;
};

inline double distance_to(const Edge& e, const Vec3& x) {
  const Vec3 along = e.to - e.from;
  const double t = std::clamp((x - e.from).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (x - (e.from + t * along)).norm();
}

inline std::vector<Edge> edges_of(const rigid::Box& box) {
  std::vector<Edge> edges;
  for (int k = 0; k < 3; ++k)
    for (const int a : {-1, 1})
      for (const int b : {-1, 1}) {
        Vec3 middle = box.half_edges, half = Vec3::Zero();
        middle[k] = 0, half[k] = box.half_edges[k];
        middle[(k + 1) % 3] *= a, middle[(k + 2) % 3] *= b;
        edges.push_back({middle - half, middle + half, 1});
      }
  return edges;
}

inline std::vector<Edge> edges_of(const rigid::Polyhedron& p) {
  std::vector<Edge> edges;
  for (const auto& e : p.mesh->edges) {
    const auto& faces = p.mesh->faces;
    const double cosine = faces[e.faces[0]].normal.dot(faces[e.faces[1]].normal);
    edges.push_back({p.mesh->vertices[e.corners[0]], p.mesh->vertices[e.corners[1]],
                     cosine > 0 ? 1 - cosine * cosine : 1});
  }
  return edges;
}

/// The nearest edge of a body of one convex part: how far it is, and its share.
struct NearestEdge {
  double distance = std::numeric_limits<double>::infinity(), share = 1;
  void meet(double d, double s) {
    if (d < distance) distance = d, share = s;
  }
  /// A circle about the z axis.
  void meet_circle(const Vec3& x, double radius, double z) {
    meet(std::hypot(std::hypot(x[0], x[1]) - radius, x[2] - z), 1);
  }
};

inline NearestEdge nearest_edge(const rigid::Shape& shape, const Vec3& x) {
  NearestEdge nearest;
  if (const auto* box = std::get_if<rigid::Box>(&shape))
    for (const Edge& e : edges_of(*box)) nearest.meet(distance_to(e, x), e.share);
  if (const auto* polyhedron = std::get_if<rigid::Polyhedron>(&shape))
    for (const Edge& e : edges_of(*polyhedron)) nearest.meet(distance_to(e, x), e.share);
  if (const auto* cylinder = std::get_if<rigid::Cylinder>(&shape))
    for (const int side : {-1, 1}) nearest.meet_circle(x, cylinder->radius, side * cylinder->half_length);
  return nearest;
}

inline bool has_edges(const rigid::Shape& shape) {
  if (const auto* compound = std::get_if<rigid::Compound>(&shape))
    return std::any_of(compound->parts.begin(), compound->parts.end(), [](const rigid::Part& part) {
      return std::isfinite(nearest_edge(rigid::Shape(part.shape), Vec3::Zero()).distance);
    });
  return std::isfinite(nearest_edge(shape, Vec3::Zero()).distance);
}

/// The wall distance of a line that meets the surface at q, with the lip (method-walls.md, "Edges"). The
/// normal is that of the distance from the surface, just before.
inline double under_lip(const rigid::Shape& shape, const Vec3& origin, const Vec3& c, double q) {
  const Vec3 x = origin + q * c;
  const NearestEdge edge = nearest_edge(shape, x);
  const double height = 0.22 * edge.share * (1 - std::fabs(2 * edge.distance - 1));
  if (q >= 1 || !(height > 0)) return q;
  constexpr double step = 1e-6;
  const double slope =
      std::fabs(rigid::signed_distance(shape, x + step * c) - rigid::signed_distance(shape, x - step * c)) /
      (2 * step);
  return std::max(q - height / std::max(slope, 0.3), std::min(q, 0.01));
}

}  // namespace silt::coupler::testing

#include <algorithm>
#include <array>
#include <vector>

#include "rigid/collision/deepest_direction.hpp"

namespace silt::rigid {
namespace {

/// Up to four points of the Minkowski difference b - a, with the point of their hull nearest to the origin.
struct Simplex {
  std::array<Vec3, 4> w;
  int size = 0;

  /// Returns the point nearest to the origin and keeps the points that span it; zero inside.
  Vec3 reduce() {
    switch (size) {
      case 1:
        return w[0];
      case 2:
        return on_edge();
      case 3:
        return on_triangle();
      default:
        return in_tetrahedron();
    }
  }

 private:
  Vec3 keep(const Simplex& s, const Vec3& x) {
    *this = s;
    return x;
  }
  Vec3 on_edge() {
    const Vec3 along = w[1] - w[0];
    const double t = -w[0].dot(along), l2 = along.squaredNorm();
    if (t <= 0) return size = 1, w[0];
    if (t >= l2) return w[0] = w[1], size = 1, w[0];
    return w[0] + t / l2 * along;
  }
  Vec3 on_triangle() {
    const Vec3 normal = (w[1] - w[0]).cross(w[2] - w[0]);
    bool inside = normal.squaredNorm() > 0;
    for (int k = 0; k < 3 && inside; ++k) inside = normal.dot(w[k].cross(w[(k + 1) % 3])) >= 0;
    if (inside) return normal * (normal.dot(w[0]) / normal.squaredNorm());
    return best_of<3, 2>();
  }
  Vec3 in_tetrahedron() {
    bool inside = true;
    for (int k = 0; k < 4 && inside; ++k) {
      const Vec3 &p = w[k], &q = w[(k + 1) % 4], &r = w[(k + 2) % 4], &opposite = w[(k + 3) % 4];
      const Vec3 normal = (q - p).cross(r - p);
      const double origin = -normal.dot(p), other = normal.dot(opposite - p);
      inside = origin * other > 0;
    }
    if (inside) return Vec3::Zero();
    return best_of<4, 3>();
  }
  /// Reduces to the best of the faces of one point less.
  template <int points, int fewer>
  Vec3 best_of() {
    Simplex best = *this;
    Vec3 nearest = Vec3::Zero();
    double least = std::numeric_limits<double>::infinity();
    for (int without = 0; without < points; ++without) {
      Simplex s = *this;
      std::copy(w.begin() + without + 1, w.begin() + points, s.w.begin() + without);
      s.size = fewer;
      const Vec3 x = s.reduce();
      if (x.squaredNorm() < least) least = x.squaredNorm(), nearest = x, best = s;
    }
    return keep(best, nearest);
  }
};

/// `size`: the length to which rounding is relative.
template <class A, class B>
std::optional<Vec3> nearest_direction(const A& a, const B& b, const Vec3& shift, const Vec3& start,
                                      double size) {
  constexpr int most_rounds = 40;
  constexpr double enough = 1e-8;  // square of the direction's relative error
  const double touching = 1e-9 * size, rounding = 1e-15 * size;
  Simplex simplex;
  Vec3 n = start;
  double distance = 0;
  for (int round = 0; round < most_rounds; ++round) {
    const Vec3 w = b.support(-n) - a.support(n) + shift;
    if (round > 0 && distance - n.dot(w) <= enough * distance + rounding) return n;
    for (int k = 0; k < simplex.size; ++k)
      if (simplex.w[k] == w) return n;
    simplex.w[simplex.size++] = w;
    const Vec3 nearest = simplex.reduce();
    distance = nearest.norm();
    if (!(distance > touching)) return {};
    n = nearest / distance;
  }
  return n;
}

constexpr std::size_t most_edge_pairs = 10000;
constexpr double tie = 1e-14;  // relative to the pair's size: edges must be better than a face by this

const PolyhedronMesh& mesh_of(const ConvexCore& core) {
  return *std::get<Polyhedron>(*core.shape).mesh;
}

std::size_t edges_of(const ConvexCore& core) {
  return core.is_box ? 12 : mesh_of(core).edges.size();
}

/// A polytope in the axes of the world, relative to a point near it.
struct Polytope {
  struct Face {
    Vec3 normal;  // unit, outward
    double offset;
  };
  struct Edge {
    Vec3 from, along;
    std::array<int, 2> faces;
  };
  std::vector<Vec3> vertices;
  std::vector<Face> faces;
  std::vector<Edge> edges;

  void reset(const ConvexCore& core, const Vec3& origin) {
    vertices.clear(), faces.clear(), edges.clear();
    if (core.is_box)
      set_box(core, core.centre - origin);
    else
      set_mesh(core, core.centre - origin, mesh_of(core));
  }
  /// Returns the least n.x over its vertices.
  double lowest(const Vec3& n) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3& x : vertices) least = std::min(least, n.dot(x));
    return least;
  }

 private:
  /// Sets a box: vertex k has the signs of the bits of k; face 2 d + s the normal of axis d, reversed if !s.
  void set_box(const ConvexCore& core, const Vec3& centre) {
    const Mat3 half = core.axes * core.half.asDiagonal();
    const auto sign = [](int k, int d) { return k >> d & 1 ? 1.0 : -1.0; };
    for (int k = 0; k < 8; ++k) vertices.push_back(centre + half * Vec3(sign(k, 0), sign(k, 1), sign(k, 2)));
    for (int face = 0; face < 6; ++face) {
      const int d = face / 2;
      const Vec3 normal = (face % 2 ? 1.0 : -1.0) * core.axes.col(d);
      faces.push_back({normal, normal.dot(centre) + core.half[d]});
    }
    for (int d = 0; d < 3; ++d)
      for (int k = 0; k < 8; ++k) {
        if (k >> d & 1) continue;
        const int e = (d + 1) % 3, f = (d + 2) % 3;
        edges.push_back({vertices[k], 2 * half.col(d), {2 * e + (k >> e & 1), 2 * f + (k >> f & 1)}});
      }
  }
  void set_mesh(const ConvexCore& core, const Vec3& centre, const PolyhedronMesh& mesh) {
    for (const Vec3& x : mesh.vertices) vertices.push_back(centre + core.axes * x);
    for (const auto& face : mesh.faces) {
      const Vec3 normal = core.axes * face.normal;
      faces.push_back({normal, normal.dot(centre) + face.offset});
    }
    for (const auto& edge : mesh.edges) {
      const Vec3& from = vertices[edge.corners[0]];
      edges.push_back({from, vertices[edge.corners[1]] - from, edge.faces});
    }
  }
};

/// Returns unit n projected normal to a vector.
Vec3 across(const Vec3& n, const Vec3& v) {
  return (n - v * (n.dot(v) / v.squaredNorm())).normalized();
}

class FacesOfDifference {
 public:
  FacesOfDifference(const Polytope& a, const Polytope& b, double scale) : a_(a), b_(b), tie_(tie * scale) {}

  Vec3 highest() {
    for (const auto& face : a_.faces) consider(face.normal, b_.lowest(face.normal) - face.offset);
    for (const auto& face : b_.faces) consider(-face.normal, a_.lowest(face.normal) - face.offset);
    edges_must_exceed_ = separation_ + tie_;
    along_edge_.resize(b_.faces.size());
    for (const auto& edge : a_.edges) test_pairs_of(edge);
    return normal_;
  }

 private:
  void consider(const Vec3& normal, double separation) {
    if (separation > separation_) normal_ = normal, separation_ = separation;
  }
  void test_pairs_of(const Polytope::Edge& u) {
    for (std::size_t f = 0; f < b_.faces.size(); ++f) along_edge_[f] = b_.faces[f].normal.dot(u.along);
    const Vec3 &from = a_.faces[u.faces[0]].normal, &to = a_.faces[u.faces[1]].normal;
    for (const auto& v : b_.edges) {
      if (!(along_edge_[v.faces[0]] * along_edge_[v.faces[1]] < 0)) continue;
      if (!(from.dot(v.along) * to.dot(v.along) < 0)) continue;
      // both great circles cross the other's arc, but perhaps on opposite sides
      Vec3 n = u.along.cross(v.along);
      if (n.dot(from + to) < 0) n = -n;
      if (!(n.dot(b_.faces[v.faces[0]].normal + b_.faces[v.faces[1]].normal) < 0)) continue;
      n = across(n.normalized(), u.along);  // for nearly parallel edges the cross product is inexact
      if (n.dot(v.from - u.from) <= edges_must_exceed_) continue;
      const double separation = b_.lowest(n) + a_.lowest(-n);
      if (separation > edges_must_exceed_) consider(n, separation);
    }
  }

  const Polytope &a_, &b_;
  double tie_, edges_must_exceed_ = 0;
  Vec3 normal_ = Vec3::Zero();
  double separation_ = -std::numeric_limits<double>::infinity();
  std::vector<double> along_edge_;  // for the faces of b, along the current edge of a
};

}  // namespace

std::optional<Vec3> gjk_direction(const ConvexCore& a, const ConvexCore& b, const Vec3& shift,
                                  const Vec3& start) {
  return nearest_direction(a, b, shift, start, length_scale(a, b));
}

std::optional<Vec3> gjk_direction(const SweptCore& a, const ShrunkCore& b, const Vec3& start, double size) {
  return nearest_direction(a, b, Vec3::Zero(), start, size);
}

Vec3 walk_uphill(const ConvexCore& a, const ConvexCore& b, const Vec3& from) {
  constexpr double apart = 0.02;  // relative to the pair's size
  constexpr int most_rounds = 6;
  Vec3 n = from;
  for (int round = 0; round < most_rounds; ++round) {
    const double away = std::max(0.0, apart * length_scale(a, b) - core_separation(a, b, n));
    const auto next = gjk_direction(a, b, away * n, n);
    if (!next) break;
    const double moved = (*next - n).squaredNorm();
    n = *next;
    if (moved < 1e-6 || away == 0) break;
  }
  return n;
}

bool has_few_edges(const ConvexCore& a, const ConvexCore& b) {
  const auto has_mesh = [](const ConvexCore& core) {
    return core.is_solid_polytope() && (core.is_box || core.is<Polyhedron>());
  };
  return has_mesh(a) && has_mesh(b) && edges_of(a) * edges_of(b) <= most_edge_pairs;
}

Peak least_depth(const ConvexCore& a, const ConvexCore& b) {
  thread_local Polytope of_a, of_b;
  of_a.reset(a, a.centre);
  of_b.reset(b, a.centre);
  const Vec3 n = FacesOfDifference(of_a, of_b, length_scale(a, b)).highest();
  return {n, core_separation(a, b, n)};
}

}  // namespace silt::rigid

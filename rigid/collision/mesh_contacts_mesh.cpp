#include "rigid/collision/mesh_contacts.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace silt::rigid {
namespace {

constexpr double mesh_rounding = 1e-12;  // relative to the meshes' size: smaller lengths are rounding
constexpr double exact = 1e-9;           // sines below it are rounding

/// A mesh and its pose in the frame of the query.
struct PlacedFeatures {
  const MeshFeatures& mesh;
  Vec3 shift;
  Mat3 turn;

  Vec3 to_query(const Vec3& x) const { return shift + turn * x; }
  Vec3 direction(const Vec3& m_query) const { return turn.transpose() * m_query; }
  Vec3 corner(std::uint32_t v) const { return to_query(mesh.corner(v)); }
  Vec3 normal(std::uint32_t t) const { return turn * mesh.normal(t); }
  bool contains(const Vec3& x_query) const {
    return mesh.mesh().contains(turn.transpose() * (x_query - shift));
  }
  bool edge_supports(std::uint32_t e, const Vec3& m, double slack) const {
    return mesh.edge_supports(e, direction(m), slack);
  }
};

/// A vertex of one mesh beside an edge or vertex of the other.
struct BesideFace {
  std::uint32_t vertex, code;
  Vec3 x, towards;  // position of the vertex; unit vector from the other feature to it; query frame
  double distance;
};

/// A vertex of one mesh over a triangle of the other.
struct OnFace {
  std::uint32_t vertex, facet, triangle;
  double height;  // above the triangle's plane
  Vec3 x;         // position of the vertex, query frame
  auto key() const { return std::tuple(vertex, -height, triangle); }
};

bool is_over(const std::array<Vec3, 3>& corners, const Vec3& n, const Vec3& x, double slack) {
  for (int k = 0; k < 3; ++k) {
    const Vec3 along = corners[(k + 1) % 3] - corners[k];
    if (n.dot(along.cross(x - corners[k])) < -slack * along.norm()) return false;
  }
  return true;
}

/// Finds the contacts of one mesh's vertices with the other mesh.
class CornersOn {
 public:
  CornersOn(const PlacedFeatures& corners, const PlacedFeatures& faces, double tolerance, double slack)
      : of_(corners),
        on_(faces),
        tolerance_(tolerance),
        deepest_(deepest(corners.mesh, faces.mesh)),
        slack_(slack) {}

  void test(std::uint32_t of_triangle, std::uint32_t on_triangle) {
    const auto& own = of_.mesh.surface().triangles()[of_triangle];
    if (!of_.mesh.is_corner(own[0]) && !of_.mesh.is_corner(own[1]) && !of_.mesh.is_corner(own[2])) return;
    const Face face = face_of(on_triangle);
    const double square = face.area.squaredNorm();
    if (!(square > 0)) return;
    for (const std::uint32_t v : own) {
      if (!of_.mesh.is_corner(v)) continue;
      const Vec3 x = of_.corner(v);
      const double above = face.area.dot(x - face.corners[0]);  // height times twice the area
      const double most = above > 0 ? tolerance_ : deepest_;
      if (above * above > most * most * square) continue;
      if (!is_over_face(v, x, on_triangle, face, above / std::sqrt(square))) find_beside(v, x, on_triangle);
    }
  }

  /// Appends the contacts beside edges and vertices, and those over faces that touch; `exchanged`: the
  /// vertices are those of the second body.
  void append(bool exchanged, std::vector<ContactPoint>& out) {
    const auto add = [&](const Vec3& x, const Vec3& normal, double gap, std::uint32_t v, std::uint32_t code) {
      const std::uint32_t own = of_.mesh.code_of_corner(v);
      const Vec3 other = x + gap * normal;
      if (exchanged)
        out.push_back({other, x, -normal, gap, mesh_feature(code, own)});
      else
        out.push_back({x, other, normal, gap, mesh_feature(own, code)});
    };
    for (const BesideFace& p : beside_) add(p.x, -p.towards, p.distance, p.vertex, p.code);
    std::sort(found_.begin(), found_.end(),
              [](const OnFace& p, const OnFace& q) { return p.key() < q.key(); });
    std::vector<const OnFace*> nearer;  // of the same vertex
    for (const OnFace& p : found_) {
      if (!nearer.empty() && nearer[0]->vertex != p.vertex) nearer.clear();
      if (p.height < 0 && !is_way_out(p, nearer)) continue;
      nearer.push_back(&p);
      add(p.x, -on_.normal(p.triangle), p.height, p.vertex, on_.mesh.code_of_facet(p.triangle));
    }
  }

 private:
  struct Face {
    std::array<Vec3, 3> corners;  // counter-clockwise seen from outside the solid
    Vec3 area;                    // outward normal times twice the area
  };
  Face face_of(std::uint32_t triangle) const {
    const auto& t = on_.mesh.surface().triangles()[triangle];
    Face face{{on_.corner(t[0]), on_.corner(t[1]), on_.corner(t[2])}, {}};
    if (on_.mesh.mesh().hollow) std::swap(face.corners[1], face.corners[2]);
    face.area = (face.corners[1] - face.corners[0]).cross(face.corners[2] - face.corners[0]);
    return face;
  }

  /// Returns whether the vertex at x is over the triangle.
  bool is_over_face(std::uint32_t v, const Vec3& x, std::uint32_t triangle, const Face& face, double height) {
    const Vec3 n = face.area.normalized();
    if (!is_over(face.corners, n, x, slack_)) return false;
    if (of_.mesh.corner_supports(v, of_.direction(-n), tilt))
      found_.push_back({v, on_.mesh.facet(triangle), triangle, height, x});
    return true;
  }

  /// Finds edges beside a vertex that touch it as on two separated convex bodies.
  void find_beside(std::uint32_t v, const Vec3& x, std::uint32_t triangle) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t e = on_.mesh.edge_of(triangle, k);
      if (!on_.mesh.is_sharp(e)) continue;
      const Vec3 foot = on_.corner(on_.mesh.edge(e).low), along = on_.corner(on_.mesh.edge(e).high) - foot;
      const double t = along.dot(x - foot) / along.squaredNorm();
      if (t > 0 && t < 1)
        add_beside(v, x, foot + t * along, on_.mesh.code_of_edge(e),
                   [&](const Vec3& m) { return on_.edge_supports(e, m, exact); });
    }
    for (const std::uint32_t w : on_.mesh.surface().triangles()[triangle])
      if (on_.mesh.is_corner(w))
        add_beside(v, x, on_.corner(w), on_.mesh.code_of_corner(w),
                   [&](const Vec3& m) { return on_.mesh.corner_supports(w, on_.direction(m), exact); });
  }
  template <class Supports>
  void add_beside(std::uint32_t v, const Vec3& x, const Vec3& foot, std::uint32_t code,
                  const Supports& supports) {
    const double distance = (x - foot).norm();
    if (distance > tolerance_ || !(distance > slack_)) return;
    const Vec3 m = (x - foot) / distance;
    if (supports(m) && of_.mesh.corner_supports(v, of_.direction(-m), exact))
      beside_.push_back({v, code, x, m, distance});
  }

  /// Returns whether a vertex behind a face can leave through it although other faces are nearer: only if all
  /// of these meet it in a concave corner.
  bool is_way_out(const OnFace& p, const std::vector<const OnFace*>& nearer) const {
    if (p.height < -1e3 * slack_ && !on_.contains(p.x)) return false;
    const auto own = on_.mesh.surface().corners(p.triangle);
    const Vec3 middle = on_.to_query((own[0] + own[1] + own[2]) / 3);
    for (const OnFace* q : nearer) {
      if (q->facet == p.facet) return false;
      const Vec3 origin = on_.to_query(on_.mesh.surface().corners(q->triangle)[0]);
      if (!(on_.normal(q->triangle).dot(middle - origin) > slack_)) return false;
    }
    return true;
  }

  const PlacedFeatures &of_, &on_;
  double tolerance_, deepest_, slack_;
  std::vector<OnFace> found_;
  std::vector<BesideFace> beside_;
};

struct EdgeSegment {
  Vec3 x, d;  // x + t d, 0 <= t <= 1
  Vec3 at(double t) const { return x + t * d; }
};

EdgeSegment segment_of(const PlacedFeatures& placed, std::uint32_t e) {
  const Vec3 x = placed.corner(placed.mesh.edge(e).low);
  return {x, placed.corner(placed.mesh.edge(e).high) - x};
}

/// Returns the length of a segment's part that is behind both faces of an edge.
double length_behind(const EdgeSegment& s, const PlacedFeatures& placed, std::uint32_t e) {
  const MeshFeatures::Edge& edge = placed.mesh.edge(e);
  const Vec3 origin = placed.corner(edge.low);
  double first = 0, last = 1;
  for (const std::uint32_t t : edge.triangles) {
    const Vec3 n = placed.normal(t);
    const double height = n.dot(s.x - origin), slope = n.dot(s.d);
    if (slope > 0) last = std::min(last, -height / slope);
    if (slope < 0) first = std::max(first, -height / slope);
    if (slope == 0 && height > 0) return 0;
  }
  return std::max(0.0, last - first) * s.d.norm();
}

void cross_edges(const PlacedFeatures& a, std::uint32_t edge_a, const PlacedFeatures& b, std::uint32_t edge_b,
                 double tolerance, std::vector<ContactPoint>& out) {
  constexpr double parallel = 1e-3;  // sine
  const EdgeSegment s = segment_of(a, edge_a), r = segment_of(b, edge_b);
  const Vec3 cross = s.d.cross(r.d), between = r.x - s.x;
  const double square = cross.squaredNorm();
  if (!(square > parallel * parallel * s.d.squaredNorm() * r.d.squaredNorm())) return;
  const double t = between.cross(r.d).dot(cross) / square, u = between.cross(s.d).dot(cross) / square;
  if (std::min({t, 1 - t, u, 1 - u}) < -mesh_rounding) return;
  Vec3 out_of_b = cross / std::sqrt(square);
  if (!b.edge_supports(edge_b, out_of_b, tilt) || !a.edge_supports(edge_a, -out_of_b, tilt)) {
    out_of_b = -out_of_b;
    if (!b.edge_supports(edge_b, out_of_b, tilt) || !a.edge_supports(edge_a, -out_of_b, tilt)) return;
  }
  const Vec3 on_a = s.at(t);
  const double gap = out_of_b.dot(on_a - r.at(u));
  if (gap > tolerance || gap < -deepest(a.mesh, b.mesh)) return;
  if (gap < 0 && std::min(length_behind(s, b, edge_b), length_behind(r, a, edge_a)) < -gap) return;
  out.push_back({on_a, on_a - gap * out_of_b, -out_of_b, gap,
                 mesh_feature(a.mesh.code_of_edge(edge_a), b.mesh.code_of_edge(edge_b))});
}

/// Calls use(edge) for the edges of which this is the first triangle, so that each edge is visited once.
template <class Use>
void for_own_edges(const MeshFeatures& mesh, std::uint32_t triangle, Use&& use) {
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t e = mesh.edge_of(triangle, k);
    if (mesh.is_sharp(e) && mesh.edge(e).triangles[0] == triangle) use(e);
  }
}

}  // namespace

double deepest(const MeshFeatures& a, const MeshFeatures& b) {
  constexpr double share = 0.05;
  const auto side = [](const MeshFeatures& m) {
    return (m.surface().box().upper - m.surface().box().lower).minCoeff();
  };
  return share * std::min(side(a), side(b));
}

void append_mesh_on_mesh(const MeshFeatures& mesh_a, const Pose& pose, const MeshFeatures& mesh_b,
                         std::span<const TrianglePair> near, double tolerance,
                         std::vector<ContactPoint>& out) {
  const PlacedFeatures a{mesh_a, pose.position, pose.orientation.toRotationMatrix()},
      b{mesh_b, Vec3::Zero(), Mat3::Identity()};
  const auto size = [](const MeshFeatures& mesh) {
    return (mesh.surface().box().upper - mesh.surface().box().lower).norm();
  };
  const double slack = mesh_rounding * (size(mesh_a) + size(mesh_b));
  CornersOn of_a(a, b, tolerance, slack), of_b(b, a, tolerance, slack);
  for (const auto& [t, r] : near) {
    of_a.test(t, r);
    of_b.test(r, t);
    for_own_edges(mesh_a, t, [&](std::uint32_t e) {
      for_own_edges(mesh_b, r, [&](std::uint32_t f) { cross_edges(a, e, b, f, tolerance, out); });
    });
  }
  of_a.append(false, out);
  of_b.append(true, out);
}

}  // namespace silt::rigid

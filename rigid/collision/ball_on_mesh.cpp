#include "rigid/collision/mesh_contacts.hpp"

#include <algorithm>
#include <cmath>

namespace silt::rigid {

namespace {

/// What of a triangle is nearest to a point.
struct Nearest {
  enum Kind { face, edge, corner } kind;
  std::uint32_t index;     // of the triangle, edge or corner
  std::uint32_t triangle;  // that found it
  Vec3 point;
  double square;  // of the distance

  auto key() const { return std::tuple(kind, index, triangle); }
  bool is_same(const Nearest& other) const { return kind == other.kind && index == other.index; }
};

/// Every triangle of an edge finds the same point on it: its ends are taken by their numbers.
Nearest nearest_on_edge(const MeshFeatures& mesh, std::uint32_t triangle, std::uint32_t e, const Vec3& x) {
  const MeshFeatures::Edge& edge = mesh.edge(e);
  const Vec3 &a = mesh.corner(edge.low), &b = mesh.corner(edge.high);
  const Vec3 along = b - a;
  const double square = along.squaredNorm(), t = square > 0 ? (x - a).dot(along) / square : 0;
  if (t <= 0) return {Nearest::corner, edge.low, triangle, a, (x - a).squaredNorm()};
  if (t >= 1) return {Nearest::corner, edge.high, triangle, b, (x - b).squaredNorm()};
  const Vec3 point = a + t * along;
  return {Nearest::edge, e, triangle, point, (x - point).squaredNorm()};
}

Nearest nearest_on_triangle(const MeshFeatures& mesh, std::uint32_t triangle, const Vec3& x) {
  const auto corners = mesh.surface().corners(triangle);
  const Vec3 n = mesh.surface().area_normal(triangle);
  bool above = n.squaredNorm() > 0;
  for (int k = 0; above && k < 3; ++k)
    above = n.dot((corners[(k + 1) % 3] - corners[k]).cross(x - corners[k])) > 0;
  if (above) {
    const Vec3 point = x - n * (n.dot(x - corners[0]) / n.squaredNorm());
    return {Nearest::face, triangle, triangle, point, (x - point).squaredNorm()};
  }
  Nearest best = nearest_on_edge(mesh, triangle, mesh.edge_of(triangle, 0), x);
  for (int k = 1; k < 3; ++k) {
    const Nearest other = nearest_on_edge(mesh, triangle, mesh.edge_of(triangle, k), x);
    if (other.square < best.square) best = other;
  }
  return best;
}

bool in_solid(const MeshFeatures& mesh, const Nearest& nearest, const Vec3& x) {
  const Vec3 from = x - nearest.point;
  if (nearest.kind == Nearest::face) return mesh.normal(nearest.triangle).dot(from) < 0;
  if (nearest.kind == Nearest::corner) return mesh.mesh().contains(x);
  const auto& [t, r] = mesh.edge(nearest.index).triangles;
  return (mesh.normal(t) + mesh.normal(r)).dot(from) < 0;
}

std::uint32_t code_of(const MeshFeatures& mesh, const Nearest& nearest) {
  if (nearest.kind == Nearest::corner && mesh.is_corner(nearest.index))
    return mesh.code_of_corner(nearest.index);
  if (nearest.kind == Nearest::edge && mesh.is_sharp(nearest.index)) return mesh.code_of_edge(nearest.index);
  return mesh.code_of_facet(nearest.triangle);
}

ContactPoint contact_at(const MeshFeatures& mesh, const Nearest& nearest, const Vec3& centre, double radius,
                        bool inside) {
  constexpr double rounding = 1e-12;
  const double distance = std::sqrt(nearest.square);
  const Vec3 towards = nearest.point - centre;
  const Vec3 normal = distance > rounding * radius ? Vec3((inside ? -1 : 1) / distance * towards)
                                                   : Vec3(-mesh.normal(nearest.triangle));
  const double gap = (inside ? -distance : distance) - radius;
  const Vec3 on_ball = centre + radius * normal;
  return {on_ball, on_ball + gap * normal, normal, gap, code_of(mesh, nearest)};
}

/// Whether all triangles around the feature, of which `found` know it as their nearest, do so.
bool is_nearest_around(const MeshFeatures& mesh, const Nearest& nearest, std::size_t found,
                       const Vec3& centre) {
  if (nearest.kind == Nearest::face) return mesh.normal(nearest.triangle).dot(centre - nearest.point) > 0;
  return found >= (nearest.kind == Nearest::edge ? 2 : mesh.valence(nearest.index));
}

}  // namespace

void append_ball_contacts(const Vec3& centre, double radius, const MeshFeatures& mesh,
                          std::span<const std::uint32_t> near, double tolerance,
                          std::vector<ContactPoint>& out) {
  const double reach = radius + tolerance;
  thread_local std::vector<Nearest> found;
  found.clear();
  for (const std::uint32_t t : near) {
    const Nearest nearest = nearest_on_triangle(mesh, t, centre);
    if (nearest.square <= reach * reach) found.push_back(nearest);
  }
  if (found.empty()) return;
  std::sort(found.begin(), found.end(), [](const Nearest& a, const Nearest& b) { return a.key() < b.key(); });
  const auto first = std::min_element(found.begin(), found.end(),
                                      [](const Nearest& a, const Nearest& b) { return a.square < b.square; });
  const bool inside = in_solid(mesh, *first, centre);
  out.push_back(contact_at(mesh, *first, centre, radius, inside));
  if (inside) return;
  const std::size_t begin = out.size() - 1;
  for (auto group = found.begin(); group != found.end();) {
    const auto end = std::find_if(group, found.end(), [&](const Nearest& n) { return !n.is_same(*group); });
    if (is_nearest_around(mesh, *group, end - group, centre)) {
      const ContactPoint p = contact_at(mesh, *group, centre, radius, false);
      const bool known = std::any_of(out.begin() + begin, out.end(),
                                     [&](const ContactPoint& q) { return q.feature == p.feature; });
      if (!known) out.push_back(p);
    }
    group = end;
  }
}

}  // namespace silt::rigid

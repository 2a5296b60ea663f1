#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "rigid/collision/manifold.hpp"
#include "rigid/collision/mesh_contacts.hpp"

namespace silt::rigid {
namespace {

/// The feature of a triangle nearest to a point.
struct Nearest {
  enum Kind { face, edge, corner } kind;
  std::uint32_t index;     // number of the triangle, edge or corner
  std::uint32_t triangle;  // through which it was found
  Vec3 point;
  double square;  // of the distance

  auto key() const { return std::tuple(kind, index, triangle); }
  bool is_same(const Nearest& other) const { return kind == other.kind && index == other.index; }
};

/// Orders the ends by vertex number, so that all triangles of an edge return bitwise the same point on it.
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

/// Returns whether the feature is the nearest one of all triangles around it, as it is of `found` triangles.
bool is_nearest_around(const MeshFeatures& mesh, const Nearest& nearest, std::size_t found,
                       const Vec3& centre) {
  if (nearest.kind == Nearest::face) return mesh.normal(nearest.triangle).dot(centre - nearest.point) > 0;
  return found >= (nearest.kind == Nearest::edge ? 2 : mesh.valence(nearest.index));
}

/// Error of a normal found by a search, relative to the pair's size.
constexpr double normal_rounding = 1e-9;
/// Depth behind a triangle, relative to the least width, beyond which the way out may be elsewhere.
constexpr double deep = 0.02;
constexpr double wide_angle = 0.6;  // radian

/// A triangle as a flat polyhedron with the feature codes 1 to 3 (corners), 4 to 6 (edges) and 7 (face).
class FlatPolyhedron {
 public:
  FlatPolyhedron() : mesh_(std::make_shared<PolyhedronMesh>()), shape_(Polyhedron{mesh_}) {
    mesh_->vertices.resize(3);
    mesh_->faces = {{Vec3::Zero(), 0, {0, 1, 2}}, {Vec3::Zero(), 0, {0, 2, 1}}};
    mesh_->edges = {{{0, 1}, {0, 1}}, {{1, 2}, {0, 1}}, {{2, 0}, {0, 1}}};
    mesh_->neighbours = {{1, 2}, {2, 0}, {0, 1}};
  }
  /// Sets the triangle and returns its centre.
  Vec3 set(const std::array<Vec3, 3>& corners, const Vec3& n) {
    const Vec3 middle = (corners[0] + corners[1] + corners[2]) / 3;
    for (int k = 0; k < 3; ++k) mesh_->vertices[k] = corners[k] - middle;
    for (const int side : {0, 1}) {
      mesh_->faces[side].normal = side == 0 ? n : Vec3(-n);
      mesh_->faces[side].offset = 0;
    }
    return middle;
  }
  const ConvexShape& shape() const { return shape_; }

 private:
  std::shared_ptr<PolyhedronMesh> mesh_;
  ConvexShape shape_;
};

/// Finds the contacts of a body with one triangle after another.
class TriangleContacts {
 public:
  TriangleContacts(const ConvexShape& body, const Pose& pose, const MeshFeatures& mesh, double tolerance,
                   std::vector<ContactPoint>& out)
      : pose_(pose),
        mesh_(mesh),
        core_(convex_core(body, {Vec3::Zero(), pose.orientation})),
        deep_(deep_behind_faces(body)),
        tolerance_(tolerance),
        out_(out) {}

  void collide(std::uint32_t triangle) {
    const std::optional<double> gap = select(triangle);
    if (!gap || *gap > tolerance_) return;
    const bool sharp = has_sharp(triangle), is_deep = *gap < -deep_;
    bool over = true;
    if (sharp || is_deep) {
      const std::optional<Vec3> found = collide_features(triangle);
      over = found && (!is_deep || !sharp || found->dot(n_) > 1 - tilt);
    }
    if (over) add_over_face(triangle);
  }
  /// Stores the triangle if the body overlaps it.
  void store_if_overlapping(std::uint32_t triangle) {
    const std::optional<double> gap = select(triangle);
    if (!gap || *gap > 0) return;
    const auto found = approach();
    if (!found || found->peak.core_gap > core_.radius) return;
    overlapped_.push_back(triangle);
    for (const Vec3& m : {n_, Vec3(-found->peak.normal)})
      if (m.dot(n_) > 0) directions_.push_back(m);
  }
  /// Adds the contact of least penetration with the hull of all overlapped triangles.
  void add_overlap() {
    if (overlapped_.empty()) return;
    const ConvexShape hull = Polyhedron{hull_of_overlapped()};
    const ConvexCore other = convex_core(hull, {Vec3::Zero(), Quat::Identity()});
    std::optional<Peak> best;
    for (const Vec3& m : directions_)
      if (const Peak peak = climb(core_, other, -m, wide_angle); !best || peak.core_gap > best->core_gap)
        best = peak;
    const Vec3& n = best->normal;
    const Vec3 on_body = core_.support(n) + core_.radius * n;
    const double gap = best->core_gap - core_.radius;
    add({on_body, on_body + gap * n, n, gap, mesh_feature(0, mesh_.code_of_facet(overlapped_.front()))});
  }

 private:
  /// Selects a triangle and returns the gap to its plane; nothing if it does not face the body's centre.
  std::optional<double> select(std::uint32_t triangle) {
    n_ = mesh_.normal(triangle);
    if (n_.isZero(0)) return {};
    corners_ = mesh_.surface().corners(triangle);
    if (mesh_.mesh().hollow) std::swap(corners_[1], corners_[2]);  // counter-clockwise about n
    for (Vec3& x : corners_) x -= pose_.position;
    if (!(n_.dot(corners_[0]) < 0)) return {};
    return n_.dot(core_.support(-n_) - corners_[0]) - core_.radius;
  }

  /// Makes a polyhedron with the members that climb() needs: vertices, their neighbours, and faces.
  std::shared_ptr<const PolyhedronMesh> hull_of_overlapped() const {
    auto hull = std::make_shared<PolyhedronMesh>();
    std::map<std::uint32_t, int> number;
    for (const std::uint32_t t : overlapped_) {
      PolyhedronMesh::Face face{mesh_.normal(t), 0, {}};
      for (const std::uint32_t v : mesh_.surface().triangles()[t]) {
        const auto [at, is_new] = number.try_emplace(v, static_cast<int>(hull->vertices.size()));
        if (is_new) hull->vertices.push_back(mesh_.corner(v) - pose_.position);
        face.corners.push_back(at->second);
      }
      face.offset = face.normal.dot(hull->vertices[face.corners[0]]);
      hull->faces.push_back(face);
    }
    hull->neighbours.resize(hull->vertices.size());
    for (const auto& face : hull->faces)
      for (const int u : face.corners)
        for (const int v : face.corners)
          if (u != v) hull->neighbours[u].push_back(v);
    return hull;
  }

  bool has_sharp(std::uint32_t triangle) const {
    const auto& t = mesh_.surface().triangles()[triangle];
    for (int k = 0; k < 3; ++k)
      if (mesh_.is_corner(t[k]) || mesh_.is_sharp(mesh_.edge_of(triangle, k))) return true;
    return false;
  }

  void add_over_face(std::uint32_t triangle) {
    thread_local std::vector<ContactPoint> points;
    points.clear();
    append_on_plane(core_, corners_[0], n_, mesh_.code_of_facet(triangle), tolerance_, points);
    for (const ContactPoint& p : points)
      if (is_over(triangle, p)) add(p);
  }
  /// A point behind the triangle at a sharp edge does not count: it leaves over the edge's other side.
  bool is_over(std::uint32_t triangle, const ContactPoint& point) const {
    const double slack = normal_rounding * deep_;
    for (int k = 0; k < 3; ++k) {
      const Vec3 along = corners_[(k + 1) % 3] - corners_[k];
      const bool behind = point.gap < -slack && mesh_.is_sharp(edge_of(triangle, k));
      if (n_.dot(along.cross(point.on_a - corners_[k])) < (behind ? slack : -slack) * along.norm())
        return false;
    }
    return true;
  }

  /// Returns the triangle as a convex core.
  ConvexCore flat() {
    const Vec3 middle = flat_.set(corners_, n_);
    return convex_core(flat_.shape(), {middle, Quat::Identity()});
  }
  std::optional<Approach> approach() { return deepest_direction(core_, flat(), tolerance_ + core_.radius); }

  /// Adds contacts with the triangle's sharp edges and corners. Returns the direction from the triangle to
  /// the body, or nothing if they are apart.
  std::optional<Vec3> collide_features(std::uint32_t triangle) {
    const auto found = approach();
    if (!found) return {};
    const Vec3 m = -found->peak.normal;
    if (!is_local_maximum(triangle, m, normal_rounding * length_scale(core_, flat()))) return m;
    thread_local std::vector<ContactPoint> points;
    points.clear();
    append_manifold(core_, flat(), *found, tolerance_, points);
    for (ContactPoint& p : points)
      if (const auto code = sharp_code(triangle, p.feature & 0xffff)) {
        p.feature = mesh_feature(static_cast<std::uint32_t>(p.feature >> 16), *code);
        add(p);
      }
    return m;
  }

  /// Returns the mesh's number of corner k; in a hollow mesh the orientation is reversed.
  int in_mesh(int k) const { return mesh_.mesh().hollow ? (3 - k) % 3 : k; }
  std::uint32_t corner_of(std::uint32_t triangle, int k) const {
    return mesh_.surface().triangles()[triangle][in_mesh(k)];
  }
  /// Returns the edge from corner k to the next.
  std::uint32_t edge_of(std::uint32_t triangle, int k) const {
    return mesh_.edge_of(triangle, mesh_.mesh().hollow ? 2 - k : k);
  }

  /// Returns whether the triangle's feature furthest along m is a local maximum of the mesh.
  bool is_local_maximum(std::uint32_t triangle, const Vec3& m, double slack) const {
    std::array<double, 3> height;
    for (int k = 0; k < 3; ++k) height[k] = m.dot(corners_[k]);
    const double highest = *std::ranges::max_element(height);
    std::array<bool, 3> top;
    for (int k = 0; k < 3; ++k) top[k] = height[k] >= highest - slack;
    if (top[0] && top[1] && top[2]) return m.dot(n_) > 0;
    for (int k = 0; k < 3; ++k)
      if (top[k] && top[(k + 1) % 3]) {
        const std::uint32_t e = edge_of(triangle, k);
        return mesh_.is_sharp(e) && mesh_.edge_supports(e, m, normal_rounding);
      }
    for (int k = 0; k < 3; ++k)
      if (top[k]) {
        const std::uint32_t v = corner_of(triangle, k);
        return mesh_.is_corner(v) && mesh_.corner_supports(v, m, normal_rounding);
      }
    return false;
  }

  std::optional<std::uint32_t> sharp_code(std::uint32_t triangle, std::uint32_t of_flat) const {
    const int k = static_cast<int>(of_flat) - 1;
    if (k < 3) {
      const std::uint32_t v = corner_of(triangle, k);
      if (mesh_.is_corner(v)) return mesh_.code_of_corner(v);
    } else if (k < 6) {
      const std::uint32_t e = edge_of(triangle, k - 3);
      if (mesh_.is_sharp(e)) return mesh_.code_of_edge(e);
    }
    return {};
  }

  void add(ContactPoint p) {
    p.on_a += pose_.position;
    p.on_b += pose_.position;
    out_.push_back(p);
  }

  const Pose& pose_;
  const MeshFeatures& mesh_;
  const ConvexCore core_;  // centred at the origin
  double deep_, tolerance_;
  std::vector<ContactPoint>& out_;
  Vec3 n_;
  std::array<Vec3, 3> corners_;  // relative to the body's centre
  FlatPolyhedron flat_;
  std::vector<std::uint32_t> overlapped_;
  std::vector<Vec3> directions_;  // candidate directions of separation
};

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
  const auto first =
      std::ranges::min_element(found, [](const Nearest& a, const Nearest& b) { return a.square < b.square; });
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

double deep_behind_faces(const ConvexShape& body) {
  return deep * std::visit([](const auto& s) { return s.least_width(); }, body);
}

void append_on_plane(const ConvexCore& body, const Vec3& origin, const Vec3& outward, std::uint32_t code,
                     double tolerance, std::vector<ContactPoint>& out) {
  const std::size_t first = out.size();
  append_plane_manifold(body, origin, outward, tolerance, out);
  for (std::size_t k = first; k < out.size(); ++k)
    out[k].feature = mesh_feature(static_cast<std::uint32_t>(out[k].feature >> (body.is_box ? 0 : 16)), code);
}

void append_curved_on_mesh(const ConvexShape& body, const Pose& pose, const MeshFeatures& mesh,
                           std::span<const std::uint32_t> near, double tolerance,
                           std::vector<ContactPoint>& out) {
  TriangleContacts contacts(body, pose, mesh, tolerance, out);
  for (const std::uint32_t t : near) contacts.collide(t);
}

void append_overlap(const ConvexShape& body, const Pose& pose, const MeshFeatures& mesh,
                    std::span<const std::uint32_t> near, std::vector<ContactPoint>& out) {
  TriangleContacts contacts(body, pose, mesh, 0, out);
  for (const std::uint32_t t : near) contacts.store_if_overlapping(t);
  contacts.add_overlap();
}

}  // namespace silt::rigid

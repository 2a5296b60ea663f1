#include "rigid/shapes/polyhedron.hpp"

#include "rigid/math/elementary.hpp"

namespace silt::rigid {
namespace {

std::uint32_t vertex_code(int vertex) {
  return vertex + 1;
}

std::uint32_t edge_code(const PolyhedronMesh& mesh, std::size_t edge) {
  return 1 + mesh.vertices.size() + edge;
}

}  // namespace

int Polyhedron::support_vertex(const Vec3& n) const {
  int best = 0;
  double furthest = mesh->vertices[0].dot(n);
  for (int v = 1; v < static_cast<int>(mesh->vertices.size()); ++v)
    if (const double h = mesh->vertices[v].dot(n); h > furthest) {
      furthest = h;
      best = v;
    }
  return best;
}

int Polyhedron::face_towards(const Vec3& n) const {
  int best = 0;
  for (std::size_t f = 1; f < mesh->faces.size(); ++f)
    if (mesh->faces[f].normal.dot(n) > mesh->faces[best].normal.dot(n)) best = static_cast<int>(f);
  return best;
}

bool Polyhedron::contains(const Vec3& x) const {
  return std::ranges::all_of(mesh->faces,
                             [&](const auto& face) { return face.normal.dot(x) - face.offset <= 0; });
}

/// Clips the line by the plane of each face.
std::optional<LineInterval> Polyhedron::line_interval(const Vec3& o, const Vec3& d) const {
  LineInterval inside = LineInterval::everything();
  for (const auto& face : mesh->faces) {
    const double height = face.normal.dot(o) - face.offset, speed = face.normal.dot(d);
    if (speed == 0 && height > 0) return {};
    if (speed < 0) inside.enter = std::max(inside.enter, -height / speed);
    if (speed > 0) inside.leave = std::min(inside.leave, -height / speed);
  }
  return inside.enter <= inside.leave ? std::optional{inside} : std::nullopt;
}

BoundingBox Polyhedron::bounding_box(const Pose& pose) const {
  BoundingBox all = BoundingBox::empty();
  for (const Vec3& v : mesh->vertices) {
    const Vec3 x = pose.to_world(v);
    all.add({x, x});
  }
  return all;
}

double Polyhedron::reach(const Pose& pose) const {
  double furthest = 0;
  for (const Vec3& v : mesh->vertices) furthest = std::max(furthest, pose.to_world(v).norm());
  return furthest;
}

MassProperties Polyhedron::mass_properties() const {
  constexpr double rounding = 1e-13;
  const PolyhedronIntegrals sum = integrals(*mesh);
  const Vec3 centre = sum.first / sum.volume;
  MassProperties p{sum.volume, sum.about + centre,
                   inertia_of(sum.second - sum.volume * centre * centre.transpose())};
  snap_to_symmetry(p, rounding);
  return p;
}

/// Returns the least width normal to a face or to two edges.
double Polyhedron::least_width() const {
  const auto width = [&](const Vec3& n) {
    double low = 0, high = 0;
    for (const Vec3& v : mesh->vertices) {
      const double at = n.dot(v - mesh->vertices[0]);
      low = std::min(low, at);
      high = std::max(high, at);
    }
    return high - low;
  };
  const auto along = [&](const PolyhedronMesh::Edge& edge) -> Vec3 {
    return (mesh->vertices[edge.corners[1]] - mesh->vertices[edge.corners[0]]).normalized();
  };
  constexpr std::size_t most_edges = 200;  // beyond, pairs of edges add nothing to the faces
  double least = std::numeric_limits<double>::infinity();
  for (const auto& face : mesh->faces) least = std::min(least, width(face.normal));
  for (std::size_t i = 0; mesh->edges.size() <= most_edges && i < mesh->edges.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 n = along(mesh->edges[i]).cross(along(mesh->edges[j]));
      if (n.norm() > 1e-6) least = std::min(least, width(n.normalized()));
    }
  return least;
}

/// Adds a ball, the vertices, and the midpoints of edges and faces.
void Polyhedron::add_inner_balls(std::vector<InnerBall>& balls) const {
  const auto middle = [&](const auto& corners) {
    Vec3 mean = Vec3::Zero();
    for (const int c : corners) mean += mesh->vertices[c] / static_cast<double>(corners.size());
    return mean;
  };
  Vec3 centre = Vec3::Zero();
  for (const Vec3& v : mesh->vertices) centre += v / static_cast<double>(mesh->vertices.size());
  balls.push_back({centre, std::max(0.0, -signed_distance(centre))});
  for (const Vec3& v : mesh->vertices) balls.push_back({v, 0});
  for (const auto& edge : mesh->edges) balls.push_back({middle(edge.corners), 0});
  for (const auto& face : mesh->faces) balls.push_back({middle(face.corners), 0});
}

Vec3 Polyhedron::half_widths() const {
  Vec3 half = Vec3::Zero();
  for (const Vec3& v : mesh->vertices) half = half.cwiseMax(v.cwiseAbs());
  return half;
}

/// Returns the ball about the centre for any x.
InnerBall Polyhedron::inner_ball(const Vec3&) const {
  double radius = half_widths().maxCoeff();
  for (const auto& face : mesh->faces) radius = std::min(radius, face.offset);
  return {Vec3::Zero(), radius};
}

void Polyhedron::kinks(const Placement& at, const Vec3& n_B, double angle, Kinks& out) const {
  const double sine = elementary::sin(angle), cosine = elementary::cos(angle);
  const int v = support_vertex(n_B);
  for (const int u : mesh->neighbours[v]) {
    const Vec3 along = (mesh->vertices[u] - mesh->vertices[v]).normalized();
    if (std::abs(along.dot(n_B)) <= sine) out.circles.push_back(at.axes * along);
  }
  for (const auto& face : mesh->faces)
    if (face.normal.dot(n_B) >= cosine) out.faces.push_back(at.axes * face.normal);
}

std::optional<Mat3> Polyhedron::curvature(const Vec3&, const Vec3& n) const {
  if (is_along(mesh->faces[face_towards(n)].normal, n)) return Mat3(Mat3::Zero());
  return std::nullopt;
}

double Polyhedron::touching_ball(const Vec3& x, const Vec3& n) const {
  BallUnderPlanes ball(n);
  for (const auto& face : mesh->faces) ball.add(face.normal, face.offset - face.normal.dot(x));
  return ball.radius;
}

void Polyhedron::face_outline(const Placement& at, int face, ContactOutline& out) const {
  out.reset();
  const auto& f = mesh->faces[face];
  out.code = edge_code(*mesh, mesh->edges.size()) + face;
  out.normal = at.axes * f.normal;
  for (std::size_t c = 0; c < f.corners.size(); ++c)
    out.corners.push_back({at.to_world(mesh->vertices[f.corners[c]]), vertex_code(f.corners[c]), 0});
  for (std::size_t e = 0; e < mesh->edges.size(); ++e) {
    const auto& edge = mesh->edges[e];
    if (edge.faces[0] != face && edge.faces[1] != face) continue;
    for (std::size_t c = 0; c < f.corners.size(); ++c) {
      const int from = f.corners[c], to = f.corners[(c + 1) % f.corners.size()];
      if ((edge.corners[0] == from && edge.corners[1] == to) ||
          (edge.corners[0] == to && edge.corners[1] == from))
        out.corners[c].edge_code = edge_code(*mesh, e);
    }
  }
}

void Polyhedron::touching_outline(const Placement& at, const Vec3& n, double slack,
                                  ContactOutline& out) const {
  const Vec3 d = at.direction_B(n);
  double furthest = -std::numeric_limits<double>::infinity();
  for (const Vec3& v : mesh->vertices) furthest = std::max(furthest, v.dot(d));
  int touching[2], count = 0;
  for (int v = 0; v < static_cast<int>(mesh->vertices.size()); ++v) {
    if (mesh->vertices[v].dot(d) < furthest - slack) continue;
    if (count < 2) touching[count] = v;
    ++count;
  }
  if (count > 2) return face_outline(at, face_towards(d), out);
  out.set_point(at.to_world(mesh->vertices[touching[0]]), vertex_code(touching[0]));
  if (count < 2) return;
  for (std::size_t e = 0; e < mesh->edges.size(); ++e) {
    const auto& c = mesh->edges[e].corners;
    if (std::min(c[0], c[1]) == touching[0] && std::max(c[0], c[1]) == touching[1])
      out.code = edge_code(*mesh, e);
  }
  out.corners[0].edge_code = out.code;
  out.corners.push_back({at.to_world(mesh->vertices[touching[1]]), vertex_code(touching[1]), out.code});
}

void Polyhedron::facing_outline(const Placement& at, const Vec3& n, ContactOutline& out) const {
  face_outline(at, face_towards(at.direction_B(n)), out);
}

void Polyhedron::plane_points(const Placement& at, const Vec3&, std::vector<PlanePoint>& out) const {
  for (std::size_t v = 0; v < mesh->vertices.size(); ++v)
    out.push_back({at.to_world(mesh->vertices[v]), vertex_code(v)});
}

}  // namespace silt::rigid

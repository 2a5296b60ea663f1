#include "silt/results/body_output.hpp"

#include <algorithm>
#include <limits>

#include "adapters/qhull/convex_hull.hpp"

namespace silt {

namespace {

using adapters::HullFace;
using rigid::ConvexShape;
using rigid::Vec3;

double width_of(const ConvexShape& shape, const Vec3& n) {
  return n.dot(rigid::support(shape, n) - rigid::support(shape, -n));
}

Vec3 half_extents(const ConvexShape& shape) {
  return 0.5 *
         Vec3(width_of(shape, Vec3::UnitX()), width_of(shape, Vec3::UnitY()), width_of(shape, Vec3::UnitZ()));
}

/// Distinct points of the surface found by the support function.
class SurfacePoints {
 public:
  SurfacePoints(const ConvexShape& shape, const Vec3& half_extents) : shape_(shape) {
    nearest_ = 1e-5 * half_extents.minCoeff();
    Vec3 sorted = half_extents;
    std::sort(sorted.begin(), sorted.end());
    middle_ = sorted[1];
  }

  const std::vector<Vec3>& all() const { return points_; }

  /// Adds the furthest points along slightly tilted normals: both ends of a straight flank or flat face are
  /// needed, of which the support function returns any point.
  void add(const Vec3& normal) {
    constexpr double aside = 1e-6;
    const Vec3 right = normal.unitOrthogonal(), up = normal.cross(right);
    for (const double r : {-aside, aside})
      for (const double u : {-aside, aside}) add_point(rigid::support(shape_, normal + r * right + u * up));
  }

  /// Returns whether the surface is further from a face of the hull than the tolerance.
  bool stands_off(const HullFace& face) const {
    double gap = std::numeric_limits<double>::infinity();
    const Vec3 furthest = rigid::support(shape_, face.normal);
    for (const int c : face.corners) gap = std::min(gap, face.normal.dot(furthest - points_[c]));
    return gap > tessellation_tolerance * std::min(0.5 * width(face.normal), middle_);
  }

 private:
  double width(const Vec3& n) const { return width_of(shape_, n); }
  void add_point(const Vec3& point) {
    const bool known = std::any_of(points_.begin(), points_.end(),
                                   [&](const Vec3& p) { return (p - point).norm() < nearest_; });
    if (!known) points_.push_back(point);
  }

  const ConvexShape& shape_;
  std::vector<Vec3> points_;
  double middle_;   // middle one of the half extents along x, y and z
  double nearest_;  // closer points are equal
};

struct Surface {
  std::vector<Vec3> vertices;
  std::vector<HullFace> faces;
};

/// Removes vertices without a face.
void leave_out_unused(Surface& surface) {
  std::vector<int> number(surface.vertices.size(), -1);
  for (const HullFace& face : surface.faces)
    for (const int c : face.corners) number[c] = 0;
  int next = 0;
  for (std::size_t k = 0; k < number.size(); ++k)
    if (number[k] == 0) surface.vertices[next] = surface.vertices[k], number[k] = next++;
  surface.vertices.resize(next);
  for (HullFace& face : surface.faces)
    for (int& c : face.corners) c = number[c];
}

/// Returns the hull of points of the surface. Where the surface is too far from a face, adds its furthest
/// point, until there is no such face (Kamenev, Comput. Math. Math. Phys. 32 (1992) 114).
Surface inscribed_surface(const ConvexShape& shape) {
  if (const auto* polyhedron = std::get_if<rigid::Polyhedron>(&shape)) {
    Surface surface{polyhedron->mesh->vertices, {}};
    for (const auto& face : polyhedron->mesh->faces) surface.faces.push_back({face.corners, face.normal});
    return surface;
  }
  constexpr double flatness = 1e-12;  // rounding: faces between close corners are not flat
  SurfacePoints points(shape, half_extents(shape));
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        if (x || y || z) points.add(Vec3(x, y, z).normalized());
  for (;;) {
    const auto faces = adapters::hull_faces(points.all(), flatness);
    const std::size_t before = points.all().size();
    for (const HullFace& face : faces)
      if (points.stands_off(face)) points.add(face.normal);
    if (points.all().size() > before) continue;
    Surface surface{points.all(), faces};
    leave_out_unused(surface);
    return surface;
  }
}

/// Returns an outward unit normal of the surface at a vertex; at edges and corners, one near that of the
/// face. n is a normal at v if n . (s - v) <= 0 for all points s of the surface, so n is moved across the
/// half-spaces that it violates (relaxation method: Agmon, Can. J. Math. 6 (1954) 382). Works on the surface
/// scaled to half extents of 1.
Vec3 normal_at(const ConvexShape& shape, const Vec3& half, const Vec3& vertex, const Vec3& face_normal) {
  constexpr int most = 300;           // few on a round surface
  constexpr double relaxation = 1.5;  // 1: to the boundary, 2: to the mirror image
  const auto outward = [&](const Vec3& squeezed) -> Vec3 {
    return squeezed.cwiseQuotient(half).normalized();
  };
  Vec3 n = face_normal.cwiseProduct(half).normalized();
  for (int i = 0; i < most; ++i) {
    const Vec3 beyond = (rigid::support(shape, outward(n)) - vertex).cwiseQuotient(half);
    const double excess = n.dot(beyond);
    if (excess <= 1e-9) break;
    n = (n - relaxation * excess / beyond.squaredNorm() * beyond).normalized();
  }
  return outward(n);
}

/// Returns the index of a vertex normal in the table; normals within 0.01 rad are equal.
int index_of_normal(const Vec3& normal, std::vector<int>& of_vertex, std::vector<Vec3>& normals) {
  for (const int known : of_vertex)
    if ((normals[known] - normal).norm() < 1e-2) return known;
  of_vertex.push_back(int(normals.size()));
  normals.push_back(normal);
  return of_vertex.back();
}

std::array<double, 3> array_of(const Vec3& v) {
  return {v[0], v[1], v[2]};
}

}  // namespace

adapters::TriangleMesh tessellation(const rigid::Part& part, double unit) {
  const Surface surface = inscribed_surface(part.shape);
  const Vec3 half = half_extents(part.shape);
  adapters::TriangleMesh mesh;
  for (const Vec3& v : surface.vertices) mesh.vertices.push_back(array_of(unit * part.pose.to_world(v)));

  std::vector<Vec3> normals;
  std::vector<std::vector<int>> normals_of_vertex(surface.vertices.size());
  for (const HullFace& face : surface.faces) {
    std::vector<int> normal_of_corner;
    for (const int c : face.corners) {
      const Vec3 normal = normal_at(part.shape, half, surface.vertices[c], face.normal);
      normal_of_corner.push_back(index_of_normal(normal, normals_of_vertex[c], normals));
    }
    for (std::size_t k = 1; k + 1 < face.corners.size(); ++k) {
      mesh.triangles.push_back({face.corners[0], face.corners[k], face.corners[k + 1]});
      mesh.triangle_normals.push_back({normal_of_corner[0], normal_of_corner[k], normal_of_corner[k + 1]});
    }
  }
  for (const Vec3& n : normals) mesh.normals.push_back(array_of(part.pose.orientation * n));
  return mesh;
}

adapters::TriangleMesh tessellation(const rigid::TriangleMesh& surface, double unit) {
  adapters::TriangleMesh mesh;
  for (const Vec3& v : surface.vertices()) mesh.vertices.push_back(array_of(unit * v));
  const auto count = std::int32_t(surface.triangles().size());
  for (std::int32_t t = 0; t < count; ++t) {
    const auto& [a, b, c] = surface.triangles()[t];
    mesh.triangles.push_back({std::int32_t(a), std::int32_t(b), std::int32_t(c)});
    mesh.normals.push_back(array_of(surface.area_normal(t).normalized()));
    mesh.triangle_normals.push_back({t, t, t});
  }
  return mesh;
}

}  // namespace silt

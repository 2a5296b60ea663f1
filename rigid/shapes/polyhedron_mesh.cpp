#include "rigid/shapes/polyhedron_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>

namespace silt::rigid {
namespace {

using Face = PolyhedronMesh::Face;
using Edge = PolyhedronMesh::Edge;

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("polyhedron: " + what);
}

std::string name_of(const char* what, std::size_t index) {
  return std::string(what) + " " + std::to_string(index);
}

/// Returns the largest extent along an axis.
double size_of(const std::vector<Vec3>& vertices) {
  Vec3 lower = vertices[0], upper = vertices[0];
  for (const Vec3& v : vertices) lower = lower.cwiseMin(v), upper = upper.cwiseMax(v);
  return (upper - lower).maxCoeff();
}

/// Returns twice the area times the normal: Newell's sum about the first corner.
Vec3 newell(const std::vector<Vec3>& vertices, const std::vector<int>& loop) {
  const Vec3& first = vertices[loop[0]];
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 1; k + 1 < loop.size(); ++k)
    sum += (vertices[loop[k]] - first).cross(vertices[loop[k + 1]] - first);
  return sum;
}

void check_input(const std::vector<Vec3>& vertices, const std::vector<std::vector<int>>& faces) {
  if (vertices.size() < 4 || faces.size() < 4) refuse("it needs at least 4 corners and 4 faces");
  std::vector<bool> used(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (!vertices[i].allFinite()) refuse(name_of("corner", i) + " is not finite");
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (faces[f].size() < 3) refuse(name_of("face", f) + " has fewer than 3 corners");
    for (const int c : faces[f]) {
      if (c < 0 || c >= int(vertices.size()))
        refuse(name_of("face", f) + " names corner " + std::to_string(c) + ", which is not there");
      used[c] = true;
    }
  }
  for (std::size_t i = 0; i < used.size(); ++i)
    if (!used[i]) refuse(name_of("corner", i) + " belongs to no face");
}

Face make_face(const std::vector<Vec3>& vertices, const std::vector<int>& loop, std::size_t index,
               double tolerance) {
  const Vec3 area = newell(vertices, loop);
  if (!(area.norm() > tolerance * tolerance)) refuse(name_of("face", index) + " has no area");
  Face face{area.normalized(), 0, loop};
  for (const int c : loop) face.offset += face.normal.dot(vertices[c]) / double(loop.size());
  for (const int c : loop)
    if (std::abs(face.normal.dot(vertices[c]) - face.offset) > tolerance)
      refuse(name_of("face", index) + " is not flat at " + name_of("corner", c));
  return face;
}

/// Requires each edge once in each direction, and one closed surface without holes (Euler).
std::vector<Edge> make_edges(const std::vector<Face>& faces, std::size_t corners) {
  std::map<std::array<int, 2>, int> face_left_of;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const auto& loop = faces[f].corners;
    for (std::size_t k = 0; k < loop.size(); ++k)
      if (!face_left_of.emplace(std::array{loop[k], loop[(k + 1) % loop.size()]}, int(f)).second)
        refuse("two faces run the same way along the edge from " + name_of("corner", loop[k]));
  }
  std::vector<Edge> edges;
  for (const auto& [ends, left] : face_left_of) {
    const auto right = face_left_of.find({ends[1], ends[0]});
    if (right == face_left_of.end())
      refuse("it is not closed: only one face has the edge from " + name_of("corner", ends[0]) + " to " +
             std::to_string(ends[1]));
    if (ends[0] < ends[1]) edges.push_back({ends, {left, right->second}});
  }
  if (corners + faces.size() != edges.size() + 2) refuse("it is not one piece without holes");
  return edges;
}

/// Requires a positive volume, so faces that are counter-clockwise seen from outside.
void check_outward(const PolyhedronMesh& mesh) {
  double volume = 0;
  for (const Face& face : mesh.faces)
    volume += newell(mesh.vertices, face.corners).dot(mesh.vertices[face.corners[0]] - mesh.vertices[0]);
  if (!(volume > 0)) refuse("its faces are clockwise seen from outside, or it has no volume");
}

void check_convex(const PolyhedronMesh& mesh, double tolerance) {
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const Face& face = mesh.faces[f];
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
      if (face.normal.dot(mesh.vertices[i]) - face.offset > tolerance)
        refuse("it is not convex: " + name_of("corner", i) + " lies outside " + name_of("face", f));
    for (std::size_t k = 0; k < face.corners.size(); ++k) {
      const Vec3& a = mesh.vertices[face.corners[k]];
      const Vec3& b = mesh.vertices[face.corners[(k + 1) % face.corners.size()]];
      const Vec3 inward = face.normal.cross(b - a).normalized();
      for (const int c : face.corners)
        if (inward.dot(mesh.vertices[c] - a) < -tolerance)
          refuse(name_of("face", f) + " is not convex at " + name_of("corner", c));
    }
  }
}

double distance_to_segment(const Vec3& a, const Vec3& b, const Vec3& x) {
  const Vec3 along = b - a;
  const double t = std::clamp((x - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (x - a - t * along).norm();
}

/// Returns the exact distance of a point that is at `height` above the face's plane.
double distance_to_face(const PolyhedronMesh& mesh, const Face& face, double height, const Vec3& x) {
  bool above = true;  // x projects onto the face
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < face.corners.size(); ++k) {
    const Vec3& a = mesh.vertices[face.corners[k]];
    const Vec3& b = mesh.vertices[face.corners[(k + 1) % face.corners.size()]];
    if (face.normal.cross(b - a).dot(x - a) >= 0) continue;
    above = false;
    least = std::min(least, distance_to_segment(a, b, x));
  }
  return above ? height : least;
}

}  // namespace

std::shared_ptr<const PolyhedronMesh> make_polyhedron_mesh(std::vector<Vec3> vertices,
                                                           const std::vector<std::vector<int>>& faces,
                                                           double flatness) {
  check_input(vertices, faces);
  const double tolerance = flatness * size_of(vertices);
  auto mesh = std::make_shared<PolyhedronMesh>();
  mesh->vertices = std::move(vertices);
  for (const auto& loop : faces)
    mesh->faces.push_back(make_face(mesh->vertices, loop, mesh->faces.size(), tolerance));
  mesh->edges = make_edges(mesh->faces, mesh->vertices.size());
  check_outward(*mesh);
  check_convex(*mesh, tolerance);
  mesh->neighbours.resize(mesh->vertices.size());
  for (const Edge& edge : mesh->edges)
    for (int k = 0; k < 2; ++k) mesh->neighbours[edge.corners[k]].push_back(edge.corners[1 - k]);
  return mesh;
}

std::shared_ptr<const PolyhedronMesh> shifted(const PolyhedronMesh& mesh, const Vec3& by) {
  auto moved = std::make_shared<PolyhedronMesh>(mesh);
  for (Vec3& v : moved->vertices) v += by;
  for (Face& face : moved->faces) face.offset += face.normal.dot(by);
  return moved;
}

std::shared_ptr<const PolyhedronMesh> scaled(const PolyhedronMesh& mesh, double factor) {
  auto larger = std::make_shared<PolyhedronMesh>(mesh);
  for (Vec3& v : larger->vertices) v *= factor;
  for (Face& face : larger->faces) face.offset *= factor;
  return larger;
}

double signed_distance(const PolyhedronMesh& mesh, const Vec3& x) {
  double highest = -std::numeric_limits<double>::infinity();
  const Face* nearest = nullptr;
  for (const Face& face : mesh.faces) {
    const double height = face.normal.dot(x) - face.offset;
    if (height > highest) highest = height, nearest = &face;
  }
  if (highest <= 0) return highest;
  double least = distance_to_face(mesh, *nearest, highest, x);
  if (least == highest) return least;  // no point of the solid is nearer than the face's plane
  for (const Face& face : mesh.faces) {
    const double height = face.normal.dot(x) - face.offset;
    if (height > 0 && height < least) least = std::min(least, distance_to_face(mesh, face, height, x));
  }
  return least;
}

PolyhedronIntegrals integrals(const PolyhedronMesh& mesh) {
  PolyhedronIntegrals sum;
  const Vec3& apex = sum.about = mesh.vertices[0];  // of all tetrahedra; limits cancellation
  for (const Face& face : mesh.faces) {
    const Vec3 a = mesh.vertices[face.corners[0]] - apex;
    for (std::size_t k = 1; k + 1 < face.corners.size(); ++k) {
      const Vec3 b = mesh.vertices[face.corners[k]] - apex, c = mesh.vertices[face.corners[k + 1]] - apex;
      const Vec3 s = a + b + c;
      const double volume = a.dot(b.cross(c)) / 6;
      sum.volume += volume;
      sum.first += volume / 4 * s;
      sum.second +=
          volume / 20 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
    }
  }
  return sum;
}

}  // namespace silt::rigid

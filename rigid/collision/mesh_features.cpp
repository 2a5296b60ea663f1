#include "rigid/collision/mesh_features.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "rigid/math/elementary.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::rigid {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

using Triangles = std::vector<TriangleMesh::Triangle>;

Triangles fans_of(const PolyhedronMesh& mesh) {
  Triangles triangles;
  for (const auto& face : mesh.faces)
    for (std::size_t k = 2; k < face.corners.size(); ++k)
      triangles.push_back({std::uint32_t(face.corners[0]), std::uint32_t(face.corners[k - 1]),
                           std::uint32_t(face.corners[k])});
  return triangles;
}

TriangleMesh surface_of(const Vec3& half) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back(half.cwiseProduct(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  Triangles triangles;
  for (const auto& [a, b, c, d] : std::initializer_list<std::array<std::uint32_t, 4>>{
           {0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}})
    triangles.push_back({a, b, c}), triangles.push_back({a, c, d});
  return {std::move(corners), std::move(triangles)};
}

/// Returns the angle between the outward normals across an edge, positive where the solid is convex.
double turn_at(const MeshFeatures& mesh, const MeshFeatures::Edge& edge) {
  const Vec3 n = mesh.normal(edge.triangles[0]), m = mesh.normal(edge.triangles[1]);
  const double angle = elementary::atan2(n.cross(m).norm(), n.dot(m));
  return n.dot(mesh.corner(edge.opposite[1]) - mesh.corner(edge.low)) < 0 ? angle : -angle;
}

}  // namespace

MeshFeatures::MeshFeatures(const Mesh& mesh) : mesh_(mesh) {
  find_edges();
  const std::uint64_t codes = surface().vertices().size() + edges_.size() + surface().triangles().size();
  if (codes >= std::uint64_t{1} << 31)
    throw std::invalid_argument("a mesh of " + std::to_string(surface().triangles().size()) +
                                " triangles is too fine for contacts: at most 700 million");
  find_rings();
  find_corners();
  find_facets();
}

bool MeshFeatures::is_at(std::uint32_t triangle, std::uint32_t code) const {
  if (code == code_of_facet(triangle)) return true;
  for (int k = 0; k < 3; ++k)
    if (code == code_of_corner(surface().triangles()[triangle][k]) ||
        code == code_of_edge(edge_of(triangle, k)))
      return true;
  return false;
}

Vec3 MeshFeatures::normal(std::uint32_t triangle) const {
  const Vec3 area = surface().area_normal(triangle);
  const double length = area.norm();
  if (!(length > 0)) return Vec3::Zero();
  return (mesh_.hollow ? -1 : 1) / length * area;
}

std::uint32_t MeshFeatures::third_corner(std::uint32_t triangle, std::uint32_t low,
                                         std::uint32_t high) const {
  for (const std::uint32_t v : surface().triangles()[triangle])
    if (v != low && v != high) return v;
  return low;
}

/// Finds the edges; an edge of four triangles becomes two edges of two triangles.
void MeshFeatures::find_edges() {
  const auto triangles = surface().triangles();
  const std::vector<TriangleSide> sides = sides_of(triangles);
  edges_.reserve(sides.size() / 2);
  edges_of_.resize(triangles.size());
  for (std::size_t i = 0; i < sides.size();) {
    const TriangleSide& s = sides[i];
    const bool pair = i + 1 < sides.size() && sides[i + 1].same_edge(s);
    const TriangleSide& r = sides[i + pair];
    const auto e = static_cast<std::uint32_t>(edges_.size());
    edges_.push_back({s.low,
                      s.high,
                      {s.triangle, r.triangle},
                      {third_corner(s.triangle, s.low, s.high), third_corner(r.triangle, s.low, s.high)}});
    edges_of_[s.triangle][s.k] = edges_of_[r.triangle][r.k] = e;
    i += 1 + pair;
  }
  sharp_.resize(edges_.size());
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const Edge& edge = edges_[e];
    const Vec3 n = normal(edge.triangles[0]), m = normal(edge.triangles[1]);
    const double bend = n.cross(m).norm(), below = n.dot(corner(edge.opposite[1]) - corner(edge.low));
    sharp_[e] = (bend > flat || n.dot(m) < 0) && below < 0;
  }
}

void MeshFeatures::find_rings() {
  ring_start_.assign(vertex_count() + 1, 0);
  for (const Edge& e : edges_) ++ring_start_[e.low + 1], ++ring_start_[e.high + 1];
  for (std::size_t v = 0; v + 1 < ring_start_.size(); ++v) ring_start_[v + 1] += ring_start_[v];
  ring_.resize(2 * edges_.size());
  std::vector<std::uint32_t> next(ring_start_.begin(), ring_start_.end() - 1);
  for (std::uint32_t e = 0; e < edges_.size(); ++e)
    ring_[next[edges_[e].low]++] = ring_[next[edges_[e].high]++] = e;
}

/// A vertex where just two sharp edges meet in a straight line is not a corner.
void MeshFeatures::find_corners() {
  std::vector<std::uint8_t> ends(vertex_count(), 0);
  std::vector<Vec3> sum(vertex_count(), Vec3::Zero());
  constexpr std::uint8_t many = 3;
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    if (!sharp_[e]) continue;
    const auto& [low, high, triangles, opposite] = edges_[e];
    const Vec3 along = (corner(high) - corner(low)).normalized();
    sum[low] += along, sum[high] -= along;
    for (const std::uint32_t v : {low, high}) ends[v] = std::min<std::uint8_t>(many, ends[v] + 1);
  }
  corner_.resize(vertex_count());
  for (std::uint32_t v = 0; v < vertex_count(); ++v)
    corner_[v] = ends[v] == many || ends[v] == 1 || (ends[v] == 2 && sum[v].norm() > flat);
}

/// Grows each facet from its first triangle to neighbours of the same normal.
void MeshFeatures::find_facets() {
  const auto count = static_cast<std::uint32_t>(surface().triangles().size());
  facet_.assign(count, none);
  std::vector<std::uint32_t> open;
  std::uint32_t facets = 0;
  for (std::uint32_t seed = 0; seed < count; ++seed) {
    if (facet_[seed] != none) continue;
    const Vec3 n = normal(seed);
    facet_[seed] = facets;
    open.assign(1, seed);
    while (!open.empty()) {
      const std::uint32_t t = open.back();
      open.pop_back();
      for (const std::uint32_t e : edges_of_[t])
        for (const std::uint32_t other : edges_[e].triangles) {
          if (facet_[other] != none) continue;
          const Vec3 m = normal(other);
          if (n.dot(m) < 0.5 || n.cross(m).norm() > flat) continue;
          facet_[other] = facets;
          open.push_back(other);
        }
    }
    ++facets;
  }
}

bool MeshFeatures::edge_supports(std::uint32_t e, const Vec3& m, double slack) const {
  const Vec3& x = corner(edges_[e].low);
  const Vec3 along = (corner(edges_[e].high) - x).normalized();
  for (const std::uint32_t v : edges_[e].opposite) {
    const Vec3 d = corner(v) - x, across = d - along.dot(d) * along;
    if (m.dot(across) > slack * across.norm()) return false;
  }
  return true;
}

bool MeshFeatures::corner_supports(std::uint32_t vertex, const Vec3& m, double slack) const {
  for (std::uint32_t k = ring_start_[vertex]; k < ring_start_[vertex + 1]; ++k) {
    const Edge& e = edges_[ring_[k]];
    const Vec3 d = corner(e.low == vertex ? e.high : e.low) - corner(vertex);
    const double rise = m.dot(d);
    if (rise > 0 && rise > slack * d.norm()) return false;
  }
  return true;
}

std::uint32_t MeshFeatures::code_across(const Vec3& m, std::uint32_t code) const {
  const auto facet_or_code = [&](std::uint32_t e) {
    for (const std::uint32_t t : edges_[e].triangles)
      if (is_along(normal(t), m)) return code_of_facet(t);
    return code;
  };
  if (code >= vertex_count() + edge_count()) return code;
  if (code >= vertex_count()) return facet_or_code(code - vertex_count());
  for (std::uint32_t k = ring_start_[code]; k < ring_start_[code + 1]; ++k)
    if (const std::uint32_t found = facet_or_code(ring_[k]); found != code) return found;
  return code;
}

std::shared_ptr<const MeshFeatures> features_of_polytope(const ConvexShape& shape) {
  const auto made = [](TriangleMesh surface) {
    return std::make_shared<const MeshFeatures>(
        Mesh{std::make_shared<const TriangleMesh>(std::move(surface)), false});
  };
  if (const auto* box = std::get_if<Box>(&shape)) return made(surface_of(box->half_edges));
  if (const auto* p = std::get_if<Polyhedron>(&shape)) return made({p->mesh->vertices, fans_of(*p->mesh)});
  return nullptr;
}

FacetCurvature::FacetCurvature(const MeshFeatures& mesh) {
  const auto triangles = mesh.surface().triangles();
  std::vector<double> area;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    area.resize(std::max<std::size_t>(area.size(), mesh.facet(t) + 1));
    area[mesh.facet(t)] += 0.5 * mesh.surface().area_normal(t).norm();
  }
  of_facet_.resize(area.size());
  const std::size_t corners = mesh.surface().vertices().size();
  facet_of_code_.assign(corners + mesh.edge_count(), none);
  std::vector<char> creased(corners, false);
  for (std::uint32_t e = 0; e < mesh.edge_count(); ++e) {
    const MeshFeatures::Edge& edge = mesh.edge(e);
    const double turn = turn_at(mesh, edge);
    if (std::abs(turn) > crease) {
      creased[edge.low] = creased[edge.high] = true;
      continue;
    }
    const std::uint32_t facet = mesh.facet(edge.triangles[0]);
    facet_of_code_[corners + e] = facet_of_code_[edge.low] = facet_of_code_[edge.high] = facet;
    if (facet != mesh.facet(edge.triangles[1])) add_edge(mesh, edge, turn, area);
  }
  for (std::size_t v = 0; v < corners; ++v)
    if (creased[v]) facet_of_code_[v] = none;
}

void FacetCurvature::add_edge(const MeshFeatures& mesh, const MeshFeatures::Edge& edge, double turn,
                              const std::vector<double>& area) {
  const Vec3 along = mesh.corner(edge.high) - mesh.corner(edge.low);
  const double length = along.norm();
  if (!(length > 0)) return;
  for (const std::uint32_t triangle : edge.triangles) {
    const std::uint32_t facet = mesh.facet(triangle);
    if (!(area[facet] > 0)) continue;
    const Vec3 across = mesh.normal(triangle).cross(along / length);
    const double weight = 0.5 * turn * length / area[facet];
    Tensor& sum = of_facet_[facet];
    sum.xx += weight * across.x() * across.x(), sum.xy += weight * across.x() * across.y();
    sum.yy += weight * across.y() * across.y(), sum.xz += weight * across.x() * across.z();
    sum.zz += weight * across.z() * across.z(), sum.yz += weight * across.y() * across.z();
  }
}

std::optional<Mat3> FacetCurvature::at(std::uint32_t code) const {
  const std::uint32_t facet = code < facet_of_code_.size()
                                  ? facet_of_code_[code]
                                  : code - static_cast<std::uint32_t>(facet_of_code_.size());
  if (facet == none) return std::nullopt;
  const Tensor& k = of_facet_[facet];
  return Mat3{{k.xx, k.xy, k.xz}, {k.xy, k.yy, k.yz}, {k.xz, k.yz, k.zz}};
}

}  // namespace silt::rigid

#include "rigid/collision/facet_curvature.hpp"

#include <cmath>

#include "rigid/math/elementary.hpp"

namespace silt::rigid {

namespace {

/// By which the outward normal turns across an edge; positive where the solid is convex.
double turn_at(const MeshFeatures& mesh, const MeshFeatures::Edge& edge) {
  const Vec3 n = mesh.normal(edge.triangles[0]), m = mesh.normal(edge.triangles[1]);
  const double angle = elementary::atan2(n.cross(m).norm(), n.dot(m));
  return n.dot(mesh.corner(edge.opposite[1]) - mesh.corner(edge.low)) < 0 ? angle : -angle;
}

}  // namespace

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

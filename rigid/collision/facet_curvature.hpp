#pragma once
// How a surface of triangles that stands for a smooth one curves: lubrication films depend on it.
#include <optional>
#include <vector>

#include "rigid/collision/mesh_features.hpp"

namespace silt::rigid {

/// From the angles between neighbouring facets: of a facet of area A with edges of length l at which the
/// normal turns by theta, with t a unit vector across the edge, the tensor sum theta l / (2 A) t t^T (E.
/// Grinspun, Y. Gingold, J. Reisman, D. Zorin, Comput. Graph. Forum 25 (2006) 547). An edge at which it turns
/// by more than a crease's angle is an edge of the smooth surface too: nothing is known of what is beyond.
class FacetCurvature {
 public:
  static constexpr double crease = 0.5;  // radian

  explicit FacetCurvature(const MeshFeatures&);
  /// The curvature tensor at a feature, by the code that contacts have (frame of the mesh, 1 / lattice unit;
  /// positive where the solid is convex); of an edge or corner within the smooth surface that of a facet
  /// beside it. None at creases and where they end.
  std::optional<Mat3> at(std::uint32_t code) const;

 private:
  struct Tensor {
    double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
  };
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  void add_edge(const MeshFeatures&, const MeshFeatures::Edge&, double turn, const std::vector<double>& area);

  std::vector<Tensor> of_facet_;
  std::vector<std::uint32_t> facet_of_code_;  // corners, then edges
};

}  // namespace silt::rigid

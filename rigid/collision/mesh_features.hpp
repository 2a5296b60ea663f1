#pragma once
// The features of a surface of triangles that can touch other bodies: its corners, its edges, its flat sides;
// and how such a surface curves if it stands for a smooth one, on which lubrication films depend.
#include <memory>
#include <optional>
#include <vector>

#include "rigid/shapes/shape_fwd.hpp"
#include "rigid/shapes/triangle_mesh.hpp"

namespace silt::rigid {

/// Neighbouring triangles in one plane are a facet: edges and corners within it are those of the triangles
/// only, not of the surface. Everything is in the frame of the mesh; normals point out of the solid.
class MeshFeatures {
 public:
  /// std::invalid_argument for a mesh of so many triangles that its features have no numbers of 31 bits.
  explicit MeshFeatures(const Mesh&);

  struct Edge {
    std::uint32_t low, high;                 // corners
    std::array<std::uint32_t, 2> triangles;  // the two it parts
    std::array<std::uint32_t, 2> opposite;   // their other corners
  };
  const TriangleMesh& surface() const { return *mesh_.surface; }
  const Mesh& mesh() const { return mesh_; }
  const Vec3& corner(std::uint32_t vertex) const { return surface().vertices()[vertex]; }
  const Edge& edge(std::uint32_t e) const { return edges_[e]; }
  std::uint32_t edge_count() const { return static_cast<std::uint32_t>(edges_.size()); }
  /// The edge from corner k of a triangle to its next.
  std::uint32_t edge_of(std::uint32_t triangle, int k) const { return edges_of_[triangle][k]; }
  std::uint32_t facet(std::uint32_t triangle) const { return facet_[triangle]; }
  /// Unit; zero for a triangle without area.
  Vec3 normal(std::uint32_t triangle) const;

  /// Says whether the solid is less than a half-space at an edge, by more than `flat` (radian): only such an
  /// edge can touch.
  bool is_sharp(std::uint32_t e) const { return sharp_[e]; }
  /// Says whether a sharp edge ends at a vertex, and does not just continue as another.
  bool is_corner(std::uint32_t vertex) const { return corner_[vertex]; }
  /// Returns how many edges end at a vertex.
  std::size_t valence(std::uint32_t vertex) const { return ring_start_[vertex + 1] - ring_start_[vertex]; }
  /// Say whether unit m (for an edge: normal to it) is a direction in which nothing near the feature is
  /// further out than the feature itself, up to a sine.
  bool edge_supports(std::uint32_t e, const Vec3& m, double slack) const;
  bool corner_supports(std::uint32_t vertex, const Vec3& m, double slack) const;
  /// Returns the number of the facet that unit m is the outward normal of, of those at the corner or edge
  /// numbered `code`: the surface lies flat there. Without one, `code`.
  std::uint32_t code_across(const Vec3& m, std::uint32_t code) const;

  /// Numbers for contacts, below 2^31: stable for one mesh. An edge or corner within a facet is the facet.
  std::uint32_t code_of_corner(std::uint32_t vertex) const { return vertex; }
  std::uint32_t code_of_edge(std::uint32_t e) const { return vertex_count() + e; }
  std::uint32_t code_of_facet(std::uint32_t triangle) const {
    return vertex_count() + edge_count() + facet_[triangle];
  }
  /// Says whether a triangle is at the corner or the edge, or in the facet, of that number.
  bool is_at(std::uint32_t triangle, std::uint32_t code) const;

  static constexpr double flat = 1e-4;

 private:
  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(surface().vertices().size()); }
  std::uint32_t third_corner(std::uint32_t triangle, std::uint32_t low, std::uint32_t high) const;
  void find_edges();
  void find_rings();
  void find_corners();
  void find_facets();

  Mesh mesh_;
  std::vector<Edge> edges_;
  std::vector<std::array<std::uint32_t, 3>> edges_of_;
  std::vector<std::uint32_t> facet_, ring_start_, ring_;  // ring: the edges that end at a vertex
  std::vector<char> sharp_, corner_;
};

/// The surface of a box or a polyhedron; nothing for a shape that has none of triangles.
std::shared_ptr<const MeshFeatures> features_of_polytope(const ConvexShape&);

/// The curvature follows from the angles between neighbouring facets (method-bodies.md, L3). An edge at which
/// the normal turns by more than a crease's angle is an edge of the smooth surface too: nothing is known of
/// the surface beyond.
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

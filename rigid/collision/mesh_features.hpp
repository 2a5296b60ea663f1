#pragma once
// The features of a triangle mesh that can touch other bodies: corners, edges and facets; and, where the mesh
// represents a smooth surface, the curvature of that surface, which lubrication needs.
#include <memory>
#include <optional>
#include <vector>

#include "rigid/shapes/shape_fwd.hpp"
#include "rigid/shapes/triangle_mesh.hpp"

namespace silt::rigid {

/// A facet is a set of adjacent triangles in one plane; edges and vertices within it are no features of the
/// surface. All in the frame of the mesh; normals point out of the solid.
class MeshFeatures {
 public:
  /// Throws std::invalid_argument if the mesh has too many triangles for feature codes of 31 bits.
  explicit MeshFeatures(const Mesh&);

  struct Edge {
    std::uint32_t low, high;                 // vertices
    std::array<std::uint32_t, 2> triangles;  // the two triangles at the edge
    std::array<std::uint32_t, 2> opposite;   // their vertices opposite to the edge
  };
  const TriangleMesh& surface() const { return *mesh_.surface; }
  const Mesh& mesh() const { return mesh_; }
  const Vec3& corner(std::uint32_t vertex) const { return surface().vertices()[vertex]; }
  const Edge& edge(std::uint32_t e) const { return edges_[e]; }
  std::uint32_t edge_count() const { return static_cast<std::uint32_t>(edges_.size()); }
  /// Returns the edge from corner k of a triangle to the next corner.
  std::uint32_t edge_of(std::uint32_t triangle, int k) const { return edges_of_[triangle][k]; }
  std::uint32_t facet(std::uint32_t triangle) const { return facet_[triangle]; }
  /// Returns the unit normal; zero for a triangle without area.
  Vec3 normal(std::uint32_t triangle) const;

  /// Returns whether an edge is convex, by more than the angle `flat` (radians); others cannot touch.
  bool is_sharp(std::uint32_t e) const { return sharp_[e]; }
  /// Returns whether a sharp edge ends at a vertex, other than to continue as another edge.
  bool is_corner(std::uint32_t vertex) const { return corner_[vertex]; }
  /// Returns the number of edges at a vertex.
  std::size_t valence(std::uint32_t vertex) const { return ring_start_[vertex + 1] - ring_start_[vertex]; }
  /// Return whether no surface nearby is further along unit m (normal to an edge), up to the sine `slack`.
  bool edge_supports(std::uint32_t e, const Vec3& m, double slack) const;
  bool corner_supports(std::uint32_t vertex, const Vec3& m, double slack) const;
  /// Returns the code of the facet at this corner or edge whose outward normal is m; without one, `code`.
  std::uint32_t code_across(const Vec3& m, std::uint32_t code) const;

  /// Codes of contacts, below 2^31, constant for a mesh. An edge or vertex within a facet has the facet's.
  std::uint32_t code_of_corner(std::uint32_t vertex) const { return vertex; }
  std::uint32_t code_of_edge(std::uint32_t e) const { return vertex_count() + e; }
  std::uint32_t code_of_facet(std::uint32_t triangle) const {
    return vertex_count() + edge_count() + facet_[triangle];
  }
  /// Returns whether a triangle has the corner or edge, or is in the facet, of this code.
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
  std::vector<std::uint32_t> facet_, ring_start_, ring_;  // ring: the edges at each vertex
  std::vector<char> sharp_, corner_;
};

/// Returns the features of a box or polyhedron; null for other shapes.
std::shared_ptr<const MeshFeatures> features_of_polytope(const ConvexShape&);

/// Curvature of the smooth surface that a mesh represents, from the angles between neighbouring facets
/// (method-bodies.md, L3). Edges with a larger angle than `crease` are edges of the smooth surface, too.
class FacetCurvature {
 public:
  static constexpr double crease = 0.5;  // radian

  explicit FacetCurvature(const MeshFeatures&);
  /// Returns the curvature tensor at a feature, by its contact code (frame of the mesh, 1 / lattice unit;
  /// positive where the solid is convex). At an edge or vertex within the smooth surface it is that of an
  /// adjacent facet. None at creases and at their ends.
  std::optional<Mat3> at(std::uint32_t code) const;

 private:
  struct Tensor {
    double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
  };
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  void add_edge(const MeshFeatures&, const MeshFeatures::Edge&, double turn, const std::vector<double>& area);

  std::vector<Tensor> of_facet_;
  std::vector<std::uint32_t> facet_of_code_;  // for vertices, then edges
};

}  // namespace silt::rigid

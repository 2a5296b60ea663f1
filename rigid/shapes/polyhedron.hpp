#pragma once
#include "rigid/shapes/polyhedron_mesh.hpp"
#include "rigid/shapes/solid.hpp"

namespace silt::rigid {

/// A convex polyhedron. The mesh is never null; its origin is the body's.
struct Polyhedron {
  static constexpr std::string_view name = "polyhedron";
  std::shared_ptr<const PolyhedronMesh> mesh;
  bool operator==(const Polyhedron&) const = default;
  static constexpr std::tuple<> fields{};  // read by silt/case/shapes.cpp: vertices or a file

  bool contains(const Vec3& x) const;
  double signed_distance(const Vec3& x) const { return rigid::signed_distance(*mesh, x); }
  std::optional<LineInterval> line_interval(const Vec3& o, const Vec3& d) const;
  BoundingBox bounding_box(const Pose&) const;
  double reach(const Pose&) const;
  Vec3 support(const Vec3& n) const { return mesh->vertices[support_vertex(n)]; }
  MassProperties mass_properties() const;
  double least_width() const;
  void add_inner_balls(std::vector<InnerBall>&) const;

  std::optional<Mat3> curvature(const Vec3& x, const Vec3& n) const;
  static constexpr bool is_polytope = true;
  Vec3 half_widths() const;
  InnerBall inner_ball(const Vec3&) const;
  Polyhedron recentred(const Vec3& centre) const { return {shifted(*mesh, -centre)}; }
  /// Feature codes number the vertices, then the edges, then the faces, from 1.
  std::size_t codes() const { return 1 + mesh->vertices.size() + mesh->edges.size() + mesh->faces.size(); }
  void kinks(const Placement&, const Vec3& n_B, double angle, Kinks& out) const;
  double touching_ball(const Vec3& x, const Vec3& n) const;
  void touching_outline(const Placement&, const Vec3& n, double slack, ContactOutline& out) const;
  void facing_outline(const Placement&, const Vec3& n, ContactOutline& out) const;
  void plane_points(const Placement&, const Vec3& n, std::vector<PlanePoint>& out) const;
  template <class Use>
  void extremes(Use&& use) const {
    for (std::size_t v = 0; v < mesh->vertices.size(); ++v)
      use.ball(mesh->vertices[v], 0, static_cast<std::uint32_t>(v));
  }
  template <class Parts>
  void surface(Parts& parts) const {
    Vec3 low = mesh->vertices.front(), high = low;
    for (const Vec3& v : mesh->vertices) {
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
    const Vec3 middle = 0.5 * (low + high);
    parts.add_shifted(SurfaceKind::planes, middle, 0.5 * (high - low));
    for (const auto& face : mesh->faces) parts.add_plane(face.normal, face.offset - face.normal.dot(middle));
  }

 private:
  int support_vertex(const Vec3& n) const;
  int face_towards(const Vec3& n) const;
  void face_outline(const Placement&, int face, ContactOutline& out) const;
};

}  // namespace silt::rigid

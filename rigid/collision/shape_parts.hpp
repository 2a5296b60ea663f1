#pragma once
// What the detection of contacts knows of a shape: its pieces, and how the surface of each curves.
#include <memory>
#include <optional>
#include <vector>

#include "rigid/bodies/contact.hpp"
#include "rigid/collision/mesh_features.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::rigid {

struct ShapeParts {
  /// with_curvature: whether curvature_at will be asked.
  ShapeParts(const Shape&, bool with_curvature);

  std::vector<Part> parts;
  std::vector<double> radii;  // of the parts' bounding spheres, about the parts' own origins
  bool sphere, half_space;
  std::optional<Tube> tube;                                   // then there are no parts
  std::shared_ptr<const MeshFeatures> mesh;                   // nor here
  std::shared_ptr<const FacetCurvature> facets;               // of the mesh, where curvature is asked for
  std::vector<std::shared_ptr<const MeshFeatures>> surfaces;  // of the parts that are polytopes, for meshes
  bool plain;                                                 // one part, whose pose is the body's
  bool smooth;  // some part of it: lubrication films may form there

  std::size_t pieces() const { return tube || mesh ? 1 : parts.size(); }
  Pose pose_of(std::size_t piece, const Pose& body) const {
    return tube || mesh || plain ? body : body * parts[piece].pose;
  }
  /// A tube is smooth, and a mesh stands for a smooth surface.
  bool is_smooth(std::size_t piece) const { return tube || mesh || rigid::is_smooth(parts[piece].shape); }
  /// The curvature tensor of a piece's surface at x, where its outward normal is unit `out` and, of a mesh,
  /// the feature has this code; x, `out` and the tensor in the frame of the pose. None at an edge or a
  /// corner.
  std::optional<Mat3> curvature_at(std::size_t piece, const Pose&, const Vec3& x, const Vec3& out,
                                   std::uint32_t code) const;
};

/// The principal radii of the gap between surfaces of these curvatures, as far as there is any: across unit
/// n. A line has the radius of its round side both ways. Two flat faces have `arm`, as have surfaces that
/// follow each other.
ReducedRadii reduced_radii(const Mat3& curvature_a, const Mat3& curvature_b, const Vec3& n, double arm);

/// Returns a b / (a + b); either may be infinite.
inline double reduced(double a, double b) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return b == infinity ? a : a == infinity ? b : a * b / (a + b);
}

}  // namespace silt::rigid

#pragma once
// Data of a shape for contact detection: its pieces and their curvature.
#include <memory>
#include <optional>
#include <vector>

#include "rigid/bodies/contact.hpp"
#include "rigid/collision/mesh_features.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::rigid {

struct ShapeParts {
  /// with_curvature: prepares for curvature_at.
  ShapeParts(const Shape&, bool with_curvature);

  std::vector<Part> parts;
  std::vector<double> radii;  // bounding radius of each part about its own origin
  bool sphere, half_space, mirrors;
  std::optional<Tube> tube;                      // if set, there are no parts
  std::shared_ptr<const MeshFeatures> mesh;      // if set, there are no parts
  std::shared_ptr<const FacetCurvature> facets;  // of the mesh, if prepared with curvature
  std::vector<std::shared_ptr<const MeshFeatures>>
      surfaces;  // of parts that are polytopes, for contacts with meshes
  bool plain;    // one part with the body's pose
  bool smooth;   // some part is smooth: lubrication films are possible

  std::size_t pieces() const { return tube || mesh ? 1 : parts.size(); }
  Pose pose_of(std::size_t piece, const Pose& body) const {
    return tube || mesh || plain ? body : body * parts[piece].pose;
  }
  /// Tubes are smooth; meshes represent smooth surfaces.
  bool is_smooth(std::size_t piece) const { return tube || mesh || rigid::is_smooth(parts[piece].shape); }
  /// Returns the curvature tensor at x, with outward unit normal `out` and, on a mesh, this feature code; x,
  /// `out` and the tensor are in the frame of the pose. None at an edge or a corner.
  std::optional<Mat3> curvature_at(std::size_t piece, const Pose&, const Vec3& x, const Vec3& out,
                                   std::uint32_t code) const;
};

/// Returns the principal radii of the gap between surfaces of these curvatures across unit n. A line contact
/// has the radius of its round side in both directions. Flat faces and conforming surfaces have `arm`.
ReducedRadii reduced_radii(const Mat3& curvature_a, const Mat3& curvature_b, const Vec3& n, double arm);

/// Returns a b / (a + b); either may be infinite.
inline double reduced(double a, double b) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return b == infinity ? a : a == infinity ? b : a * b / (a + b);
}

}  // namespace silt::rigid

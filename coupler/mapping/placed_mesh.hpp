#pragma once
// A mesh at a pose, for the kernels of object mapping.
#include <vector>

#include "coupler/mapping/mesh_kernels.hpp"
#include "rigid/math/types.hpp"
#include "rigid/shapes/triangle_mesh.hpp"

namespace silt::coupler {

/// Its corners are rounded to whole units: the same in every block.
class PlacedMesh {
 public:
  /// Keeps a reference to the mesh.
  void place(const rigid::TriangleMesh&, const rigid::Pose&);
  /// In cells.
  rigid::BoundingBox box() const;
  /// Triangles whose boxes overlap a box of cells (an image of the domain's), and perhaps some near it.
  TriangleView near(const rigid::Vec3& low, const rigid::Vec3& high);

 private:
  const rigid::TriangleMesh* mesh_ = nullptr;
  rigid::Pose pose_;
  std::vector<Whole3> corner_;
  std::vector<float> rough_;
  Whole3 base_;
  std::vector<std::uint32_t> near_;
};

}  // namespace silt::coupler

#pragma once
// A mesh at a pose, for the kernels of object mapping.
#include <unordered_map>
#include <vector>

#include "coupler/mapping/mesh_kernel.hpp"
#include "rigid/math/types.hpp"
#include "rigid/shapes/triangle_mesh.hpp"

namespace silt::coupler {

/// Triangles by the planes of lattice points that they meet.
class SortedByPlanes {
 public:
  /// number(k): of the k-th triangle of `count`.
  template <class Number>
  void sort(std::span<const rigid::TriangleMesh::Triangle>, const std::vector<Corner>&, std::size_t count,
            Number&& number);
  std::span<const TrianglesByPlanes> parts() const { return parts_; }

 private:
  std::vector<std::uint32_t> lists_;
  std::vector<TrianglesByPlanes> parts_;
};

/// Its corners are rounded to whole units: the same in every block.
class PlacedMesh {
 public:
  /// Keeps a reference to the mesh.
  void place(const rigid::TriangleMesh&, const rigid::Pose&);
  /// Returns the bounding box in cells.
  rigid::BoundingBox box() const;
  /// Triangles whose boxes overlap a box of cells (an image of the domain's), and perhaps some near it, valid
  /// up to the next call.
  TriangleView near(const rigid::Vec3& low, const rigid::Vec3& high);
  /// Sets the bits of the cells whose centres are inside, or outside if it is hollow, all but two at either
  /// end of the window; `low`: cell of its bit 0 in the coordinates of the mesh's image. A row changes sides
  /// wherever it crosses a triangle, in whatever order these come.
  void mark(bool hollow, lbm::Int3 low, BitWindow&);

 private:
  const rigid::TriangleMesh* mesh_ = nullptr;
  rigid::Pose pose_;
  std::vector<Corner> corner_;
  std::vector<std::uint32_t> near_;  // numbers of triangles
  SortedByPlanes of_all_, of_near_;
  bool all_sorted_ = false;  // at this pose
};

/// The meshes that a rank maps, each where it was placed last.
class PlacedMeshes {
 public:
  PlacedMesh& at(const rigid::TriangleMesh& mesh, const rigid::Pose& pose) {
    PlacedMesh& placed = placed_[&mesh];
    placed.place(mesh, pose);
    return placed;
  }

 private:
  std::unordered_map<const rigid::TriangleMesh*, PlacedMesh> placed_;
};

}  // namespace silt::coupler

#pragma once
// A mesh at a pose, for the kernels of object mapping.
#include <unordered_map>
#include <vector>

#include "coupler/mapping/mesh_kernel.hpp"
#include "coupler/mapping/reflection.hpp"
#include "rigid/math/types.hpp"
#include "rigid/shapes/triangle_mesh.hpp"

namespace silt::coupler {

/// Triangles sorted by the planes of lattice points that they meet.
class SortedByPlanes {
 public:
  /// number(k) returns the index of the k-th of `count` triangles.
  template <class Number>
  void sort(std::span<const rigid::TriangleMesh::Triangle>, const std::vector<Corner>&, std::size_t count,
            Number&& number);
  std::span<const TrianglesByPlanes> parts() const { return parts_; }

 private:
  std::vector<std::uint32_t> lists_;
  std::vector<TrianglesByPlanes> parts_;
};

/// Corners are rounded to whole units, equally in every block.
class PlacedMesh {
 public:
  /// Refers to the mesh.
  void place(const rigid::TriangleMesh&, const rigid::Pose&, const Reflection&);
  /// Returns the bounding box in cells.
  rigid::BoundingBox box() const;
  /// Returns at least the triangles whose boxes overlap a box of cells (in an image of the domain); valid
  /// until the next call.
  TriangleView near(const rigid::Vec3& low, const rigid::Vec3& high);
  /// Sets the bits of cells whose centres are inside, or outside a hollow mesh, without the outer two at
  /// either end of the window; `low` is the cell of its bit 0 in the coordinates of the image. A row changes
  /// sides at each triangle it crosses, in any order.
  void mark(bool hollow, lbm::Int3 low, BitWindow&);

 private:
  const rigid::TriangleMesh* mesh_ = nullptr;
  rigid::Pose pose_;
  Reflection reflection_;
  rigid::Vec3 position_;  // of the reflected mesh
  rigid::Mat3 turn_;
  std::vector<Corner> corner_;
  std::vector<std::uint32_t> near_;  // indices of triangles
  SortedByPlanes of_all_, of_near_;
  bool all_sorted_ = false;  // at this pose
};

/// The meshes of a rank at their last poses.
class PlacedMeshes {
 public:
  PlacedMesh& at(const rigid::TriangleMesh& mesh, const rigid::Pose& pose, const Reflection& reflection) {
    PlacedMesh& placed = placed_[&mesh];
    placed.place(mesh, pose, reflection);
    return placed;
  }

 private:
  std::unordered_map<const rigid::TriangleMesh*, PlacedMesh> placed_;
};

}  // namespace silt::coupler

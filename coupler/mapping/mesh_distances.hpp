#pragma once
// Wall distances of the links that a mesh cuts, found triangle by triangle.
#include <cstdint>
#include <vector>

#include "coupler/mapping/placed_mesh.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "rigid/shapes/triangle_mesh.hpp"

namespace silt::coupler {

class MeshDistances {
 public:
  /// Keeps a reference to the meshes.
  explicit MeshDistances(PlacedMeshes& placed) : placed_(placed) {}
  /// Finds the distances of all links from fluid cells of the block to cells of the mask.
  void find(const rigid::Mesh&, const BlockMap&, const BodyMask&);
  /// Sets those of links at places that count from a cell of the block: where they first meet a triangle, in
  /// links. A link that meets none, as an end of it is within rounding of the surface, is cut in the ratio of
  /// the distances of its ends.
  template <class T>
  void set(lbm::Int3 corner, const std::uint32_t* place, std::size_t count, T* q);

 private:
  void find_near_cells();
  LinkDistances view();
  double by_nearest_points(lbm::Int3 cell, int direction) const;

  PlacedMeshes& placed_;
  const rigid::Mesh* mesh_ = nullptr;
  const BlockMap* map_ = nullptr;
  const BodyMask* mask_ = nullptr;
  BitWindow near_, fluid_;             // near_: fluid cells of the block next to cells of the mask
  std::vector<std::uint32_t> before_;  // how many of them come before each word
  std::vector<std::uint32_t> least_;   // of every direction of each of them, in units
  std::vector<std::uint32_t> looked_up_;
};

}  // namespace silt::coupler

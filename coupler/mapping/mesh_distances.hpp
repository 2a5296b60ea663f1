#pragma once
// Wall distances of links to a mesh, found triangle by triangle.
#include <cstdint>
#include <vector>

#include "coupler/mapping/placed_mesh.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "rigid/shapes/triangle_mesh.hpp"

namespace silt::coupler {

class MeshDistances {
 public:
  /// Refers to the meshes.
  explicit MeshDistances(PlacedMeshes& placed) : placed_(placed) {}
  /// Finds the distances of all links from fluid cells of the block to cells of the mask.
  void find(const rigid::Mesh&, const BlockMap&, const BodyMask&);
  /// Sets the distances q at which links, at places that count from `corner`, first meet a triangle. A link
  /// that meets none, since one of its ends is within rounding of the surface, is cut in the ratio of the
  /// distances of its ends.
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
  BitWindow near_, fluid_;             // near_: fluid cells of the block with a neighbour in the mask
  std::vector<std::uint32_t> before_;  // number of cells of near_ before each word
  std::vector<std::uint32_t> least_;   // per direction and cell of near_, in units
  std::vector<std::uint32_t> looked_up_;
};

}  // namespace silt::coupler

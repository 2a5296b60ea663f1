#pragma once
// Wall distances of the links that a mesh cuts, found triangle by triangle.
#include <cstdint>
#include <span>
#include <vector>

#include "coupler/mapping/mesh_crossings.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "rigid/shapes/mesh.hpp"

namespace silt::coupler {

class MeshDistances {
 public:
  /// Finds the distances of all links from fluid cells of the block to cells of the mask.
  void find(const rigid::Mesh&, const BlockMap&, const BodyMask&);
  /// Of the link from a cell of the block along c_i, in links: where it first meets a triangle. A link that
  /// meets none, as an end of it is within rounding of the surface, is cut in the ratio of the distances of
  /// its ends.
  double of(lbm::Int3 cell, int direction) const;

 private:
  void meet_lines(const Lines&, std::span<const std::uint32_t> triangles);
  void note(lbm::Int3 from, lbm::Int3 to, int direction, std::int64_t distance);
  std::uint64_t key(lbm::Int3 cell, int direction) const;
  void keep_least(std::uint64_t key, std::uint32_t distance);
  void grow();

  const rigid::Mesh* mesh_ = nullptr;
  const BlockMap* map_ = nullptr;
  const BodyMask* mask_ = nullptr;
  lbm::Int3 origin_;  // of the block, in the coordinates of the mesh's image
  PlacedMesh placed_;
  // a table with open addresses
  struct Entry {
    std::uint64_t key = 0;  // 0: none
    std::uint32_t distance = 0;
  };
  std::size_t place_of(std::uint64_t key) const;
  std::vector<Entry> entries_;
  std::size_t used_ = 0;
};

}  // namespace silt::coupler

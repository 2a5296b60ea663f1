#pragma once
// Object mapping: a cell is solid if its centre is inside a body (the paper, section IV) or a curved wall.
// Where bodies overlap, the cell belongs to the lower id. The map depends on poses alone, equally on all
// ranks.
#include <span>

#include "coupler/mapping/placed_mesh.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "lbm/blocks/domain.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"
#include "rigid/shapes/surface_parts.hpp"

namespace silt::coupler {

class MapBodies {
 public:
  /// `link_reach` is lbm::link_reach of the wall scheme: masks whose links would not change are kept.
  MapBodies(const lbm::Domain&, const rigid::World&, std::span<const lbm::CellBox> blocks, int link_reach);

  /// Maps every body known here at its mapping pose. A block in which no pose changed keeps its map: then
  /// `changed` is false and `before` equals `solid`.
  void operator()(const rigid::BodySet&);
  /// Maps walls on coarser cells instead. No surface lies near those, so each block is entirely solid or
  /// fluid.
  void map_walls(const rigid::BodySet&);
  /// Returns whether the last mapping changed some block.
  bool changed() const;
  const std::vector<BlockMap>& blocks() const { return blocks_; }
  PlacedMeshes& meshes() { return meshes_; }

 private:
  struct Image {
    rigid::BodyId id;
    std::size_t row;
    lbm::Int3 shift;
    BitFrame frame;
    bool hollow = false;
    Reflection reflection{};
    /// Returns whether the mask, of the same body, is that of this image.
    bool is(const BodyMask& mask) const { return mask.shift == shift && mask.reflection == reflection; }
  };
  void map_block(BlockMap&, const rigid::BodySet&);
  void find_images(const BlockMap&, const rigid::BodySet&);
  void add_images(const BlockMap&, const rigid::BodySet&, std::size_t row);
  void add_endless(const BlockMap&, const rigid::BodySet&, std::size_t row);
  void add_reflections(const BlockMap&);
  bool nothing_changed(const BlockMap&, const rigid::BodySet&) const;
  void find_kept(BlockMap&);
  /// Returns whether a cell that links of the mask may read turned solid or fluid.
  bool changed_around(const BlockMap&, BodyMask&) const;
  BitFrame near_frame(const BodyMask&) const;
  const BitWindow& near_cells(const BlockMap&, BodyMask&) const;
  void mark(const BlockMap&, const rigid::Shape&, BodyMask&);

  const lbm::Domain& domain_;
  const rigid::World& world_;
  int link_reach_;
  bool is_mirrored_ = false;  // some side is free-slip
  std::vector<BlockMap> blocks_;
  std::vector<Image> found_;             // in the current block
  rigid::SurfaceParts<double> surface_;  // of the current body
  PlacedMeshes meshes_;
};

}  // namespace silt::coupler

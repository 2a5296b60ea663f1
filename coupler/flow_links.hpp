#pragma once
// The links of all blocks of a fluid with the surfaces in it: built again where the map has changed, with
// what wall schemes need around them, the pairs of populations that lie in several blocks.
#include <optional>
#include <span>
#include <vector>

#include "coupler/mapping/build_links.hpp"
#include "coupler/mapping/cell_bits.hpp"
#include "coupler/mapping/map_bodies.hpp"
#include "coupler/spec/flow_spec.hpp"
#include "lbm/fluid.hpp"
#include "lbm/walls/cut_links.hpp"
#include "lbm/walls/pairs_across.hpp"

namespace silt::coupler {

template <class T>
class FlowLinks {
 public:
  /// Refers to all but the spec.
  FlowLinks(const CouplingSpec& spec, const rigid::World& world, lbm::Fluid<T>& fluid, MapBodies& map)
      : spec_(spec), world_(world), fluid_(fluid), map_(map), meshes_(map.meshes()) {
    for (std::size_t b = 0; b < fluid.blocks().size(); ++b)
      blocks_.emplace_back(fluid.device()), mappings_.emplace_back(fluid.device());
    if (!lbm::reads_beyond(spec.wall_scheme) || world.shapes.empty()) return;
    pairs_.emplace(fluid.domain(), fluid.comm(), fluid.blocks(), fluid.device());
    for (const BlockMap& of : map.blocks()) columns_.emplace_back(of.solid);
    for (std::size_t b = 0; b < blocks_.size(); ++b) blocks_[b].pairs_across = pairs_->of(int(b));
  }

  const CouplingSpec& spec() const { return spec_; }
  const rigid::World& world() const { return world_; }
  int count_blocks() const { return int(blocks_.size()); }
  BlockLinks<T>& operator[](std::size_t b) { return blocks_[b]; }
  std::span<BlockLinks<T>> blocks() { return blocks_; }
  /// Returns the number of cut links on this rank.
  std::uint64_t count() const {
    std::uint64_t all = 0;
    for (const BlockLinks<T>& block : blocks_) all += block.count;
    return all;
  }

  /// Builds the links of the blocks whose map has changed, and calls built(block) after each.
  template <class Built>
  void rebuild(const rigid::BodySet& bodies, Built&& built) {
    const lbm::WallFluid<T> wall_fluid(fluid_.spec());
    const lbm::Domain& domain = fluid_.domain();
    rigid::Vec3 periods;
    for (int d = 0; d < 3; ++d) periods[d] = domain.periodic(d) ? domain.cells()[d] : 0;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const BlockMap& map = map_.blocks()[b];
      if (!map.changed) continue;
      fluid_.set_idle(int(b), !map.has_fluid());
      const lbm::PassOrder& order = fluid_.pass_order(int(b));
      build_links<T>(map, world_, bodies, {spec_, wall_fluid, order, &meshes_, &mappings_[b], periods},
                     blocks_[b].surfaces);
      blocks_[b].order_groups(order);
      blocks_[b].leave_to_device();
      hold_excess(b);
      built(int(b));
    }
    if (pairs_ && pairs_->chooses()) choose_pairs();
  }
  /// Call after the body force has changed.
  void take_force() {
    const lbm::WallFluid<T> wall_fluid(fluid_.spec());
    for (BlockLinks<T>& block : blocks_)
      for (auto& surface : block.surfaces) surface.links.fluid = wall_fluid;
  }
  /// Exchanges the pairs between blocks, after the exchange of the fluid. Collective.
  void exchange_pairs() {
    if (pairs_) pairs_->exchange(fluid_.blocks(), fluid_.parity());
  }

 private:
  void hold_excess(std::size_t b) {
    std::vector<lbm::RowRange> rows;
    for (std::size_t k = 0; k < blocks_[b].surfaces.size(); ++k) {
      if (blocks_[b].surfaces[k].links.groups.empty()) continue;
      const BitFrame& frame = map_.blocks()[b].masks[k].frame();
      const lbm::Int3 end = frame.low + frame.size;
      rows.push_back({frame.low.y, end.y, frame.low.z, end.z});
    }
    fluid_.hold_excess(int(b), rows);
  }
  void choose_pairs() {
    for (std::size_t b = 0; b < columns_.size(); ++b)
      if (map_.blocks()[b].changed) columns_[b].reset(map_.blocks()[b].solid);
    pairs_->choose([&](int b, lbm::Int3 x, int axis) {
      const CellBits& solid = map_.blocks()[b].solid;
      return axis == 1 ? columns_[b].from(solid, x.x, x.y, x.z) : solid.from(x.x, x.y, x.z);
    });
  }

  CouplingSpec spec_;
  const rigid::World& world_;
  lbm::Fluid<T>& fluid_;
  const MapBodies& map_;
  std::vector<BlockLinks<T>> blocks_;
  std::vector<DeviceMapping<T>> mappings_;  // per block
  MeshDistances meshes_;
  std::optional<lbm::PairsAcross<T>> pairs_;  // for schemes that read beyond
  std::vector<SideColumns> columns_;          // per block, for pairs_
};

}  // namespace silt::coupler

#include "coupler/mapping/build_links.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/mapping/bit_kernel.hpp"
#include "coupler/mapping/crossing_links.hpp"
#include "coupler/mapping/endless_cylinder.hpp"
#include "coupler/mapping/link_groups.hpp"
#include "coupler/mapping/measured_surface.hpp"
#include "lbm/blocks/pass_order.hpp"
#include "lbm/walls/pairs_across.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

using lbm::Int3;
using rigid::Vec3;

namespace {

/// Planes [z, z + count) of a frame.
struct Planes {
  int z, count;
};

/// Returns whether links of the body may be within `rim` cells of the block's faces or in another block.
bool touches_rim(const BitFrame& f, Int3 block, int rim) {
  for (int d = 0; d < 3; ++d)
    if (f.low[d] < rim - 1 || f.low[d] + f.size[d] > block[d] - (rim - 1)) return true;
  return false;
}

/// Lists the links of a body plane by plane, measures and groups them. Keeps its memory for the next body.
template <class T>
class LinkWriter {
 public:
  LinkWriter(const BlockMap& map, const lbm::PassOrder& sweep, WallScheme scheme, MeshDistances& meshes,
             DeviceMapping<T>& device)
      : map_(map),
        sweep_(sweep),
        scheme_(scheme),
        places_across_(map.box.size),
        device_(device),
        surface_(scheme, meshes, device),
        groups_(scheme) {}

  /// Builds the links of a body, whose frame is already set, or has a device count them if it may mark the
  /// cells of this shape. `radius` is its bounding radius, or 0 if its resistance is not needed.
  void body(const BodyMask& mask, const rigid::Shape& shape, bool may_mark, const MappedMotion& mapped,
            double radius, SurfaceLinks<T>& surface) {
    mask_ = &mask;
    const BitFrame& frame = mask.frame();
    if (mask.any && (frame.pitch > 1 << lbm::place_x_bits || frame.size.y > 1 << lbm::place_y_bits))
      throw std::invalid_argument(
          "a body or wall of more than 4096 cells across a block; use smaller domain.blocks");
    lbm::CutLinks<T>& links = surface.links;
    const int exponent = lbm::resistance_exponent(radius);
    if (mask.any && !mask.reflection.any() && may_mark && surface_.leaves_to_device(shape)) {
      surface_.leave_to_device(surface, shape, mask, mapped,
                               radius > 0 ? T(std::ldexp(1.0, -exponent)) : T(0));
      return counted_.push_back({&mask, &surface});
    }
    if (!mask.reflection.any())  // else its cells were and are solid
      device_.change(surface, &mask, mask.before < 0 ? nullptr : &map_.masks_before[mask.before]);
    groups_.begin(links);
    if (mask.any) write(shape, links.frame);
    groups_.end();
    surface.device.groups.clear();
    surface_.set_rates(links, shape, mapped);
    if (radius > 0) surface.resistance = lbm::resistance_of(links, exponent);
    if (!device_.has_links()) return;
    to_device(links.place, links.q, links.rate, links.across);
    renew(surface.device.groups, links.groups.size());
    device_.upload(std::span<const lbm::LinkGroup>(links.groups), surface.device.groups.data());
    if (!links.groups.empty()) device_.tell(surface, mapped.middle());
  }
  /// Lets the device list and measure the links that it counts.
  void finish() {
    device_.count();
    for (std::uint32_t n = 0; n < counted_.size(); ++n) {
      const auto& [mask, surface] = counted_[n];
      groups_.begin(surface->links);
      device_.for_slabs(n, [&](int z, const KindCounts& counts) {
        groups_.add_counted(counts, mask->frame().low + Int3{0, 0, z});
      });
      device_.for_edge_slabs(n, [&](int z, std::uint32_t links) {
        groups_.add_counted_crossing(links, mask->frame().low + Int3{0, 0, z - 1});
      });
      groups_.end_for_device();
      const auto& groups = surface->links.groups;
      if (groups.empty()) {  // it is near the block
        surface->links.rate.clear(), surface->resistance = {};
        continue;
      }
      renew(surface->device.groups, groups.size());
      device_.list(*surface, n);
    }
    device_.run();
  }

 private:
  int reach() const { return lbm::link_reach(scheme_); }  // of a link, in cells

  /// A surface whose links a device counts.
  struct Counted {
    const BodyMask* mask;
    SurfaceLinks<T>* surface;
  };
  void write(const rigid::Shape& shape, const lbm::SurfaceFrame& at) {
    const BitFrame& frame = mask_->frame();
    surface_.reset(shape, map_, *mask_, at);
    const Int3 n = map_.box.size;
    solid_.reset(frame);
    fill_rows(solid_, n, 1, [&](int x, int y, int z) { return map_.solid.from(x, y, z); });
    const bool at_rim = touches_rim(frame, n, reach());
    find_open(at_rim);
    constexpr int words_a_group = 16;  // for small bodies: links enough for a group
    const int step = std::clamp(words_a_group / frame.plane, 1, 1 << lbm::place_z_bits);
    for (int z = 1; z < frame.size.z - 1; z += step) {
      const Planes planes{z, std::min(step, frame.size.z - 1 - z)};
      const std::size_t most = bits_in(z - 1, z + planes.count + 1);
      if (most == 0) continue;
      inner_groups(planes, most);
      if (at_rim) group(planes, 1, frame.size.y - 1, rim_, most, -1);
    }
    groups_.end_deferred();
    if (surface_.has_crossings()) crossing_groups(at);
  }

  void crossing_groups(const lbm::SurfaceFrame& at) {
    const BitFrame& frame = mask_->frame();
    crossings_.find_cells(map_, *mask_);
    for (int z = 1; z < frame.size.z - 1; z += CrossingLinks<T>::planes) {
      crossings_.list(z, at, surface_.view());
      groups_.add_crossing(crossings_.place(), crossings_.q(), frame.low + Int3{0, 0, z - 1});
    }
  }

  /// Finds the block's fluid cells; separates those at the rim, within a link's reach of ghost cells.
  void find_open(bool at_rim) {
    const BitFrame& frame = mask_->frame();
    const Int3 n = map_.box.size;
    inner_.reset(frame);
    if (!at_rim) {
      for (std::size_t k = 0; k < frame.words(); ++k) inner_.words()[k] = ~solid_.words()[k];
      return;
    }
    rim_.reset(frame);
    for (const bool rim : {false, true})
      fill_rows(rim ? rim_ : inner_, n, 1, [&](int x, int y, int z) {
        return ~map_.solid.from(x, y, z) & cells_of_block({x, y, z}, n, reach(), rim);
      });
  }

  /// Adds one group per strip of the dense pass.
  void inner_groups(Planes planes, std::size_t most) {
    const BitFrame& frame = mask_->frame();
    const int last = std::min(frame.low.z + planes.z + planes.count, map_.box.size.z - reach()) - 1;
    if (last < reach()) return;
    const int first = std::max(frame.low.y + 1, reach()),
              end = std::min(frame.low.y + frame.size.y - 1, map_.box.size.y - reach());
    for (int y = first; y < end;) {
      const int next = std::min(sweep_.next_row(y, reach()), end);
      group(planes, y - frame.low.y, next - frame.low.y, inner_, most, sweep_.ready(y, last, reach()));
      y = next;
    }
  }

  /// Adds the links of open cells in rows [y0, y1) of planes; `most` bounds their number per direction.
  void group(Planes planes, int y0, int y1, const BitWindow& open, std::size_t most, int ready) {
    const Int3 corner = mask_->frame().low + Int3{0, 0, planes.z};
    LinkList<T> list = groups_.list(corner, planes.count, ready, lbm::D3Q19::directions * most);
    const std::uint32_t clear = classify({planes.z, planes.count, y0, y1}, open, most, list);
    if (list.n == 0) return;
    surface_.measure(list);
    for (std::uint32_t k = clear; k < list.n; ++k) groups_.defer(LinkKind::single_cell, list, k);
    list.n = clear;
    if (lbm::reads_beyond(scheme_)) defer_gaps_and_pairs(list);
    groups_.add(LinkKind::own, list);
  }

  /// Lists the links, those of single-cell gaps last. Returns the number of the others.
  std::uint32_t classify(const FrameRows& rows, const BitWindow& open, std::size_t most, LinkList<T>& list) {
    const std::size_t room = lbm::D3Q19::directions * most + 3 * lbm::link_lanes;
    if (single_cell_.size() < room) single_cell_.resize(room);
    const LinkBits bits{mask_->bits.words(), solid_.words(), open.words(), lbm::reads_behind(scheme_)};
    const LinkCounts found =
        bit_kernels().list_links(mask_->frame(), rows, bits, list.place, single_cell_.data());
    std::copy_n(single_cell_.data(), found.single_cell, list.place + found.clear);
    list.n = found.clear + found.single_cell;
    return found.clear;
  }

  /// Defers links whose second cell behind is solid, or whose cell behind is in another block.
  void defer_gaps_and_pairs(LinkList<T>& list) {
    beyond_.resize(std::max<std::size_t>(beyond_.size(), list.n));
    for (std::uint32_t m =
             bit_kernels().list_beyond(list.place, list.n, list.corner, map_.solid, beyond_.data());
         m-- > 0;) {
      const std::uint32_t k = beyond_[m];
      const Int3 cell = list.corner + lbm::place_cell(list.place[k]);
      const int i = lbm::place_direction(list.place[k]);
      if (map_.solid.test(cell - lbm::D3Q19::c[i] - lbm::D3Q19::c[i]))
        groups_.defer(LinkKind::two_cells, list, k);
      else
        groups_.defer(LinkKind::across, list, k, places_across_(cell, i));
      list.remove(k);
    }
  }

  /// Returns the number of cells in planes [z0, z1) of the mask, which bounds the links per direction.
  std::size_t bits_in(int z0, int z1) const {
    const BitFrame& f = mask_->frame();
    const std::uint64_t* const w = mask_->bits.words();
    std::size_t n = 0;
    for (std::size_t k = std::size_t(std::max(z0, 0)) * f.plane;
         k < std::size_t(std::min(z1, f.size.z)) * f.plane; ++k)
      n += std::popcount(w[k]);
    return n;
  }

  const BlockMap& map_;
  const lbm::PassOrder& sweep_;
  WallScheme scheme_;
  lbm::PlacesAcross<lbm::D3Q19> places_across_;
  const BodyMask* mask_ = nullptr;  // current body
  DeviceMapping<T>& device_;
  MeasuredSurface<T> surface_;
  CrossingLinks<T> crossings_;
  LinkGroups<T> groups_;
  BitWindow solid_, inner_, rim_;
  std::vector<std::uint32_t> single_cell_, beyond_;
  std::vector<Counted> counted_;
};

template <class T>
void write_links(const BlockMap& map, const rigid::World& world, const rigid::BodySet& bodies,
                 const LinkRules<T>& rules, std::vector<SurfaceLinks<T>>& surfaces) {
  DeviceMapping<T> none(Device::cpu), &device = rules.device ? *rules.device : none;
  std::pmr::memory_resource* const memory = memory_of(device.device());
  std::vector<SurfaceLinks<T>> before;
  before.reserve(map.masks.size());
  for (std::size_t k = 0; k < map.masks.size(); ++k)
    before.push_back(
        {.links = lbm::CutLinks<T>::in(memory), .device = typename SurfaceLinks<T>::DeviceCopy(memory)});
  before.swap(surfaces);
  std::vector<std::uint8_t> stays(before.size(), 0);
  const int link_reach = lbm::link_reach(rules.coupling.wall_scheme);
  PlacedMeshes placed;
  MeshDistances own(placed);
  device.begin(map, rules.coupling.wall_scheme);
  LinkWriter<T> writer(map, rules.sweep, rules.coupling.wall_scheme, rules.meshes ? *rules.meshes : own,
                       device);
  for_masks(map.masks, [&](std::size_t k) {
    const BodyMask& mask = map.masks[k];
    if (mask.before >= 0) surfaces[k] = std::move(before[mask.before]), stays[mask.before] = 1;
    surfaces[k].row = mask.row, surfaces[k].reflection = mask.reflection;
    if (mask.kept) return;
    lbm::CutLinks<T>& links = surfaces[k].links;
    links.fluid = rules.fluid, links.frame = surface_frame(mask.frame(), centre_in(map, mask));
    links.frame.whole = !touches_rim(mask.frame(), map.box.size, link_reach);
    const std::int32_t shape = bodies.shape[mask.row];
    const bool wants_resistance =
        mask.row < bodies.first_wall() && bodies.motion[mask.row] != rigid::Motion::fixed;
    const std::optional<rigid::Shape> endless =
        endless_cylinder(world.shapes[shape], mask.pose, rules.periods);
    writer.body(mask, endless ? *endless : world.shapes[shape], !endless,
                coupling_of(bodies, mask.row).mapped, wants_resistance ? world.bounding_radii[shape] : 0,
                surfaces[k]);
  });
  for (std::size_t k = 0; k < before.size(); ++k)
    if (!stays[k] && !map.masks_before[k].reflection.any())
      device.change(before[k], nullptr, &map.masks_before[k]);
  writer.finish();
}

}  // namespace

template <class T>
void build_links(const BlockMap& map, const rigid::World& world, const rigid::BodySet& bodies,
                 const LinkRules<T>& rules, std::vector<SurfaceLinks<T>>& surfaces) {
  write_links(map, world, bodies, rules, surfaces);
}

template void build_links(const BlockMap&, const rigid::World&, const rigid::BodySet&,
                          const LinkRules<float>&, std::vector<SurfaceLinks<float>>&);
template void build_links(const BlockMap&, const rigid::World&, const rigid::BodySet&,
                          const LinkRules<double>&, std::vector<SurfaceLinks<double>>&);

}  // namespace silt::coupler

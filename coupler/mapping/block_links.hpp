#pragma once
// The cut links of a block, surface by surface, in the order of their application, and their sums in a step.
#include <cstdint>
#include <vector>

#include "coupler/mapping/reflection.hpp"
#include "cpu/prefetch.hpp"
#include "lbm/blocks/domain.hpp"
#include "lbm/blocks/pass_order.hpp"
#include "lbm/walls/cut_links.hpp"
#include "lbm/walls/device_links.hpp"
#include "rigid/shapes/turned_parts.hpp"

namespace silt::coupler {

/// A surface in memory of a device, which sets `frame`, `group_count` and `measured` if it lists the links,
/// and its shape.
template <class T>
struct MappedSurface {
  lbm::DeviceSurface<T> links;
  struct Shape {
    rigid::ShapeView<T> parts;
    const rigid::Plane<double>* planes;  // to mark cells
  } shape;
};

/// The links of one periodic image of a body, or of a wall.
template <class T>
struct SurfaceLinks {
  lbm::CutLinks<T> links{};
  struct DeviceCopy {
    DeviceArray<std::uint64_t> cells;  // CellsOnDevice, if the device lists the links
    DeviceArray<lbm::LinkGroup> groups;
    DeviceArray<rigid::ShapePart> parts;
    DeviceArray<rigid::Plane<T>> planes;
    DeviceArray<rigid::Plane<double>> exact_planes;
    bool has_edges = false;                // of the parts
    DeviceArray<MappedSurface<T>> record;  // one element
    lbm::DeviceSurface<T> told{};          // its links as they were sent last
    explicit DeviceCopy(std::pmr::memory_resource* m = std::pmr::new_delete_resource())
        : cells(m), groups(m), parts(m), planes(m), exact_planes(m), record(m) {}
  } device{};                        // the links in memory of a device
  lbm::ResistanceSums resistance{};  // of movable bodies; updated with the links
  Reflection reflection{};           // of the image; motion, sums and resistance are those of the image
  // in the current step:
  std::size_t row = 0;  // in the BodySet
  lbm::SurfaceMotion motion{};
  lbm::LinkSums sums{};
  std::uint32_t left = 0;  // groups not yet applied
  bool finished = false;   // the body is solved for

  bool moves_as(const SurfaceLinks& o) const { return row == o.row && reflection == o.reflection; }
};

/// Groups [begin, end) of a list.
struct GroupRange {
  std::uint32_t begin, end;
  bool empty() const { return begin == end; }
};

/// The links of a block; surface k belongs to mask k. A CPU applies groups in the order of its caches. A
/// device applies all at once, and the lists of groups are empty.
template <class T>
struct BlockLinks {
  explicit BlockLinks(Device device = Device::cpu) : at_once(device) {}

  struct Group {
    std::uint32_t surface, number;
  };
  std::vector<SurfaceLinks<T>> surfaces;
  std::vector<Group> inner;                          // groups by the part of the pass they wait for
  std::vector<std::uint32_t> first_inner;            // per part, and the end of the last
  std::vector<Group> rim;                            // groups after the halo exchange, crossing ones last
  std::size_t count = 0;                             // of links
  lbm::LinkSlots slots;                              // of the current step
  const lbm::BeyondPair<T>* pairs_across = nullptr;  // of the current step, for schemes that read beyond
  lbm::DeviceLinks<T> at_once;                       // all surfaces, for their device

  /// Return the inner groups that wait for a part of the dense pass, and all inner groups.
  GroupRange inner_after(int part) const {
    if (std::size_t(part) + 1 >= first_inner.size()) return {0, 0};
    return {first_inner[part], first_inner[part + 1]};
  }
  GroupRange all_inner() const { return {0, std::uint32_t(inner.size())}; }
  /// Calls visit(surface, group, next) for groups [begin, end) of a list. Prefetches first the surface, then
  /// the group and then its links.
  template <class Visit>
  void for_groups(const std::vector<Group>& order, std::size_t begin, std::size_t end, Visit&& visit) {
    const auto links_of = [&](const Group& g) -> const lbm::CutLinks<T>& {
      return surfaces[g.surface].links;
    };
    const auto group_of = [&](const Group& g) -> const lbm::LinkGroup& {
      return links_of(g).groups[g.number];
    };
    const auto fetch_surface = [&](const Group& g) {
      const char* const surface = reinterpret_cast<const char*>(&surfaces[g.surface]);
      for (std::size_t line = 0; line < sizeof(SurfaceLinks<T>); line += 64)
        prefetch_to_write(surface + line);
    };
    for_ahead_in(
        order, begin, end, 6, fetch_surface, 4, [&](const Group& g) { prefetch_to_read(&group_of(g)); }, 2,
        [&](const Group& g) { links_of(g).prefetch(group_of(g)); },
        [&](std::size_t k) {
          lbm::NextGroup<T> next;
          if (k + 1 < end) next = {&links_of(order[k + 1]), &group_of(order[k + 1])};
          visit(surfaces[order[k].surface], group_of(order[k]), next);
        });
  }
  /// Passes the links to the device. Call after they were built.
  void leave_to_device() {
    at_once.clear();
    for (std::size_t k = 0; k < surfaces.size(); ++k) {
      SurfaceLinks<T>& surface = surfaces[k];
      auto& record = surface.device.record;
      if (at_once.device() == Device::cpu) {
        record.resize(1);
        record[0].links = lbm::device_surface(surface.links, surface.links.groups.data(), 0);
      }
      at_once.add(record.empty() ? nullptr : &record.data()->links, surface.links,
                  k > 0 && surfaces[k - 1].moves_as(surface));
    }
  }
  /// Calls visit(number, first surface with links) for each body of a device.
  template <class Visit>
  void for_bodies(Visit&& visit) const {
    std::uint32_t next = 0;
    for (std::size_t k = 0; k < at_once.size(); ++k)
      if (at_once.body(k) == next) visit(next++, k);
  }
  /// Call once the motions of a step are set, for a block whose first cell is `lower`.
  void begin_step(double time, const lbm::Domain& domain, lbm::Int3 lower) {
    for_bodies([&](std::uint32_t body, std::size_t k) { at_once.set_motion(body, surfaces[k].motion); });
    at_once.begin_step(time, slots, domain, lower);
  }
  void apply_at_once(lbm::Block<T>& block, lbm::ForceForm form) {
    if (at_once.device() == Device::cpu) return;
    if (at_once.size() > 0) at_once.apply(block, surfaces.front().links.fluid, pairs_across, form);
    for_bodies([&](std::uint32_t body, std::size_t k) { surfaces[k].sums = at_once.sums(body); });
  }
  /// Sets inner, first_inner, rim and count. Call after links were built.
  void order_groups(const lbm::PassOrder& sweep) {
    first_inner.assign(sweep.parts() + 2, 0), rim.clear(), count = 0;
    for (const auto& surface : surfaces)
      for (const lbm::LinkGroup& g : surface.links.groups) {
        count += g.count;
        if (g.ready >= 0) ++first_inner[g.ready + 2];
      }
    if (at_once.device() != Device::cpu) return first_inner.clear();
    for (std::size_t part = 1; part < first_inner.size(); ++part) first_inner[part] += first_inner[part - 1];
    inner.resize(first_inner.back());
    std::vector<Group> crossing;
    for (std::uint32_t k = 0; k < surfaces.size(); ++k) {
      const auto& groups = surfaces[k].links.groups;
      for (std::uint32_t g = 0; g < groups.size(); ++g)
        if (groups[g].ready >= 0)
          inner[first_inner[groups[g].ready + 1]++] = {k, g};
        else
          (groups[g].crossing ? crossing : rim).push_back({k, g});
    }
    rim.insert(rim.end(), crossing.begin(), crossing.end());
    first_inner.pop_back();
  }
};

}  // namespace silt::coupler

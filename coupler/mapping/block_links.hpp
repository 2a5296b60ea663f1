#pragma once
// The cut links of a block, surface by surface, in the order in which they are applied, with what a step sums
// over them, and what links in gaps of a single cell know of the wall behind.
#include <cstdint>
#include <vector>

#include "cpu/prefetch.hpp"
#include "lbm/blocks/domain.hpp"
#include "lbm/blocks/pass_order.hpp"
#include "lbm/walls/cut_links.hpp"
#include "lbm/walls/device_links.hpp"

namespace silt::coupler {

/// One periodic image of a body, or a wall.
template <class T>
struct SurfaceLinks {
  lbm::CutLinks<T> links{};
  struct DeviceCopy {
    DeviceArray<std::uint64_t> cells;  // BodyMask::bits, if it lists them
    DeviceArray<lbm::LinkGroup> groups;
    DeviceArray<lbm::DeviceSurface<T>> record;  // one
    explicit DeviceCopy(std::pmr::memory_resource* m = std::pmr::new_delete_resource())
        : cells(m), groups(m), record(m) {}
  } device{};                               // where a device has the links
  std::vector<std::uint32_t> gap_places{};  // of the links of `single_cell_gap`
  lbm::ResistanceSums resistance{};         // of bodies that move; renewed with the links
  // of the step under way:
  std::size_t row = 0;  // of the BodySet
  lbm::SurfaceMotion motion{};
  lbm::LinkSums sums{};
  std::uint32_t left = 0;  // groups yet to be applied
  bool finished = false;   // the body has been solved for
};

/// Links of `single_cell_gap` come in pairs, along i and against it from one cell, mostly of two surfaces; or
/// a side of the domain is there instead. Gives each link what the formula wants of the wall on the other
/// side.
template <class T>
class SingleCellGaps {
 public:
  /// Finds the wall on the other side of all links; call when the links of the box were built.
  void pair(const std::vector<SurfaceLinks<T>>&, const lbm::Domain&, const lbm::CellBox&);
  /// Fills opposite_q and opposite_u of all links; call when the motions of a step are set, with the surfaces
  /// as they were paired.
  void set(std::vector<SurfaceLinks<T>>&) const;
  /// Has a device fill them, from step to step.
  void leave_to(lbm::DeviceLinks<T>&);

 private:
  struct Link : lbm::OppositeLink<T> {
    std::uint64_t key;         // of the pair
    std::uint32_t own_number;  // of place and q
  };
  struct Group {
    std::uint32_t surface, first, count;  // of opposite_q and opposite_u
  };
  template <class F>
  void for_pairs(F&&);  // calls f with the numbers of the two links of each pair
  void pad(std::vector<SurfaceLinks<T>>&, DeviceArray<T> lbm::CutLinks<T>::*values) const;

  std::vector<Link> links_;
  std::vector<Group> groups_;
  std::vector<std::uint32_t> table_;  // of links_, by key; 0: empty, else from 1 on
};

/// Groups [begin, end) of an order.
struct GroupRange {
  std::uint32_t begin, end;
  bool empty() const { return begin == end; }
};

/// Surface k is mask k of the block. The processor applies groups in orders that suit its caches; a device
/// all at once, and the orders are empty.
template <class T>
struct BlockLinks {
  explicit BlockLinks(Device device = Device::cpu) : at_once(device) {}

  struct Group {
    std::uint32_t surface, number;
  };
  std::vector<SurfaceLinks<T>> surfaces;
  std::vector<Group> inner;                          // groups in the order of the parts they wait for
  std::vector<std::uint32_t> first_inner;            // of a part; the last one's end
  std::vector<Group> rim;                            // that wait for the halo exchange, crossing ones last
  std::size_t count = 0;                             // links
  lbm::LinkSlots slots;                              // of the step under way
  SingleCellGaps<T> gaps;                            // under schemes that know the opposite wall
  const lbm::BeyondPair<T>* pairs_across = nullptr;  // of the step under way, under schemes that read beyond
  lbm::DeviceLinks<T> at_once;                       // of all surfaces, where a device applies them

  /// The inner groups that wait for a part of the dense pass; all of them.
  GroupRange inner_after(int part) const {
    if (std::size_t(part) + 1 >= first_inner.size()) return {0, 0};
    return {first_inner[part], first_inner[part + 1]};
  }
  GroupRange all_inner() const { return {0, std::uint32_t(inner.size())}; }
  /// Calls visit(surface, group, next) for groups of an order, from the one at `begin` to the one before
  /// `end`. What they need is fetched ahead: first their surface, then where the group is, then its links.
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
  /// Leaves the links to the passes of a device, if there is one; call when they were built or paired.
  void leave_to_device() {
    if (at_once.device() == Device::cpu) return;
    at_once.clear();
    gaps.leave_to(at_once);
    for (const SurfaceLinks<T>& surface : surfaces)
      at_once.add(surface.device.record.data(), surface.links.groups);
  }
  /// Call when the motions of a step are set.
  void begin_step() {
    gaps.set(surfaces);
    for (std::size_t k = 0; k < at_once.size(); ++k)
      at_once.set_motion(k, surfaces[k].motion, surfaces[k].links.frame.reach, surfaces[k].links.age);
  }
  void apply_at_once(lbm::Block<T>& block, lbm::ForceForm form) {
    if (at_once.size() > 0) at_once.apply(block, surfaces.front().links.fluid, slots, pairs_across, form);
    for (std::size_t k = 0; k < at_once.size(); ++k) surfaces[k].sums = at_once.sums(k);
  }
  /// Fills inner, first_inner, rim and count; call when links were built.
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

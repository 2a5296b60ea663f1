#pragma once
// The cut links of a block, surface by surface, in the order in which they are applied.
#include <cstdint>
#include <vector>

#include "coupler/mapping/single_cell_gaps.hpp"
#include "lbm/pass_order.hpp"

namespace silt::coupler {

/// Groups [begin, end) of an order.
struct GroupRange {
  std::uint32_t begin, end;
  bool empty() const { return begin == end; }
};

/// Surface k is mask k of the block.
template <class T>
struct BlockLinks {
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

  /// The inner groups that wait for a part of the dense pass; all of them.
  GroupRange inner_after(int part) const {
    if (std::size_t(part) + 1 >= first_inner.size()) return {0, 0};
    return {first_inner[part], first_inner[part + 1]};
  }
  GroupRange all_inner() const { return {0, std::uint32_t(inner.size())}; }
  /// A hint that the groups after the k-th of an order will be wanted soon, one after the other: first their
  /// surface, then where the group is, then its links.
  void prefetch(const std::vector<Group>& order, std::size_t k) const {
    constexpr std::size_t ahead = 2;
    if (k + 3 * ahead < order.size()) {
      const char* const surface = reinterpret_cast<const char*>(&surfaces[order[k + 3 * ahead].surface]);
      for (std::size_t line = 0; line < sizeof(SurfaceLinks<T>); line += 64)
        lbm::prefetch_to_write(surface + line);
    }
    if (k + 2 * ahead < order.size())
      lbm::prefetch_to_read(
          &surfaces[order[k + 2 * ahead].surface].links.groups[order[k + 2 * ahead].number]);
    if (k + ahead < order.size()) {
      const lbm::CutLinks<T>& next = surfaces[order[k + ahead].surface].links;
      next.prefetch(next.groups[order[k + ahead].number]);
    }
  }
  lbm::NextGroup<T> next_group(const std::vector<Group>& order, std::size_t k, std::size_t end) const {
    if (k + 1 >= end) return {};
    const lbm::CutLinks<T>& links = surfaces[order[k + 1].surface].links;
    return {&links, &links.groups[order[k + 1].number]};
  }
  /// Fills inner, first_inner, rim and count; call when links were built.
  void order_groups(const lbm::PassOrder& sweep) {
    first_inner.assign(sweep.parts() + 2, 0), rim.clear(), count = 0;
    for (const auto& surface : surfaces)
      for (const lbm::LinkGroup& g : surface.links.groups) {
        count += g.count;
        if (g.ready >= 0) ++first_inner[g.ready + 2];
      }
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

#pragma once
// The cut links of a block, surface by surface, with what a step sums over them.
#include <cstdint>
#include <vector>

#include "lbm/cut_links.hpp"
#include "lbm/domain.hpp"
#include "lbm/sweep.hpp"

namespace silt::coupler {

/// One periodic image of a body, or a wall.
template <class T>
struct SurfaceLinks {
  lbm::CutLinks<T> links;
  lbm::StiffnessSums stiffness;  // implicit coupling only; renewed with the links
  // of the step under way:
  lbm::SurfaceMotion motion;
  lbm::LinkSums sums;
  std::uint32_t left = 0;  // groups yet to be applied
  bool finished = false;   // the body has been solved for
};

/// Links of `narrow` come in pairs, along i and against it from one cell, mostly of two surfaces; or a side
/// of the domain is there instead. Gives each link what the formula wants of the wall on the other side.
template <class T>
class NarrowGaps {
 public:
  /// Fills far_q of all links, and far_u where that is a side's; call when the links of the box were built.
  void pair(std::vector<SurfaceLinks<T>>&, const lbm::Domain&, const lbm::CellBox&);
  /// Fills the rest of far_u; call when the motions of a step are set, with the surfaces as they were paired.
  void set_velocities(std::vector<SurfaceLinks<T>>&) const;

 private:
  struct Link {
    std::uint64_t key;             // cell and direction
    std::uint32_t surface, place;  // of far_q
    std::int32_t direction;
    lbm::Int3 cell;
    T q;
  };
  struct Far {
    std::uint32_t surface, place;  // that wants it
    std::uint32_t of;              // surface there
    std::int32_t direction;
    lbm::Int3 cell;
  };
  std::vector<Link> links_;
  std::vector<Far> fars_;
};

/// Surface k is mask k of the block.
template <class T>
struct BlockLinks {
  struct Group {
    std::uint32_t surface, number;
  };
  std::vector<SurfaceLinks<T>> surfaces;
  std::vector<Group> inner;                // groups in the order of the parts they wait for
  std::vector<std::uint32_t> first_inner;  // of a part; the last one's end
  lbm::LinkSlots slots;                    // of the step under way
  NarrowGaps<T> gaps;                      // under `parabolic`

  /// A hint that the inner groups after the k-th will be wanted soon, one after the other: first their
  /// surface, then where the group is, then its links.
  void prefetch(std::uint32_t k) const {
    constexpr std::uint32_t ahead = 2;
    if (k + 3 * ahead < inner.size()) {
      const char* const surface = reinterpret_cast<const char*>(&surfaces[inner[k + 3 * ahead].surface]);
      for (std::size_t line = 0; line < sizeof(SurfaceLinks<T>); line += 64)
        __builtin_prefetch(surface + line);
    }
    if (k + 2 * ahead < inner.size())
      __builtin_prefetch(&surfaces[inner[k + 2 * ahead].surface].links.groups[inner[k + 2 * ahead].number]);
    if (k + ahead < inner.size()) {
      const lbm::CutLinks<T>& next = surfaces[inner[k + ahead].surface].links;
      next.prefetch(next.groups[inner[k + ahead].number]);
    }
  }
  /// Fills inner and first_inner; call when links were built.
  void order_groups(const lbm::Sweep& sweep) {
    first_inner.assign(sweep.parts() + 2, 0);
    for (const auto& surface : surfaces)
      for (const lbm::LinkGroup& g : surface.links.groups)
        if (g.ready >= 0) ++first_inner[g.ready + 2];
    for (std::size_t part = 1; part < first_inner.size(); ++part) first_inner[part] += first_inner[part - 1];
    inner.resize(first_inner.back());
    for (std::uint32_t k = 0; k < surfaces.size(); ++k) {
      const auto& groups = surfaces[k].links.groups;
      for (std::uint32_t g = 0; g < groups.size(); ++g)
        if (groups[g].ready >= 0) inner[first_inner[groups[g].ready + 1]++] = {k, g};
    }
    first_inner.pop_back();
  }
};

}  // namespace silt::coupler

#pragma once
// The exchange along the links of one group, with the populations of their block, for the passes of devices
// (SILT_BUILD): a vector of links at a time, or one (SILT_SCALAR). The kernels of the processor, whose loop
// lists slots ahead (cut_links_kernel.cpp), share its formulas (link_exchange.hpp).
#include "device/for_each.hpp"
#include "lbm/walls/link_exchange.hpp"

namespace silt::lbm::SILT_BUILD {

/// The links of one group, from whose first one on their arrays are given.
template <class T>
struct LinksOfGroup {
  const LinkGroup& group;
  const LinkSlots& slots;
  PlaceOrigin<T> origin;
  WallDistances<T> distance;
  const std::uint32_t* place;
  const T *opposite_q, *opposite_u;  // null: unknown
  const std::uint32_t* across;
  const BeyondPair<T>* pairs_across;  // of the block
  T* corner;                          // of the block's data at the group's corner, from which slots count
  ExcessQuanta<T>* excess;            // of the group's corner

  SILT_DEVICE Places<T> at(int l) const { return Places<T>(place + l, origin); }
};

/// The slots of a vector of links by LinkRow, computed when they are used.
template <WallScheme scheme, class T>
struct ComputedSlots {
  using L = Lanes<T>;
  using Whole = typename L::Whole;
  const LinkSlots& slots;
  const Places<T>& at;

  SILT_DEVICE Whole operator()(int row) const {
    if constexpr (scheme == WallScheme::single_cell_gap)
      if (row > out_row) return at.cell + slots.out[row - out_row];
    const Whole out = at.slots(slots.out), back = at.slots(slots.back);
    if (row == out_row) return out;
    if (row == back_row) return back;
    const SlotsBehind<Whole> behind(out, back, L::look_up(slots.step, at.direction));
    return row == behind_row    ? behind.behind
           : row == against_row ? behind.against
           : row == away_row    ? behind.away
                                : behind.toward;
  }
};

/// A vector of links, from the l-th one of a group on.
template <WallScheme scheme, class T>
struct LinkAt {
  using L = Lanes<T>;
  using V = typename L::Real;
  const LinksOfGroup<T>& links;
  int l;
  const Places<T>& at;
  const ComputedSlots<scheme, T>& slots;
  V q;

  SILT_DEVICE V operator()(int row) const { return L::gather(links.corner, slots(row)); }
  /// Reads the pair beyond from the block, or from its pairs across.
  SILT_DEVICE BeyondPair<V> beyond() const {
    if (!links.group.across) return {(*this)(away_row), (*this)(toward_row)};
    T away[L::count], toward[L::count];
    for (int k = 0; k < L::count; ++k) {
      const BeyondPair<T>& pair = links.pairs_across[links.across[l + k]];
      away[k] = pair.away, toward[k] = pair.toward;
    }
    return {load<V>(away), load<V>(toward)};
  }
  SILT_DEVICE OppositeWall<V> opposite() const {
    if (scheme != WallScheme::single_cell_gap || !links.opposite_q) return {};
    return {load<V>(links.opposite_q + l), load<V>(links.opposite_u + l)};
  }
  /// Adds lane by lane, since links of several directions in one vector may share a cell.
  [[gnu::always_inline]] SILT_DEVICE void give(const ExcessLanes<T>& given) const {
    ExcessQuanta<T> of[L::count];
    std::int32_t cell[L::count];
    store(of, given), store(cell, at.cell);
#pragma GCC unroll 16
    for (int k = 0; k < L::count; ++k) add_to(links.excess[cell[k]], of[k]);
  }
};

/// Applies a member's share of a group, `together` vectors of links at a time: reads them all before it
/// writes.
template <WallScheme scheme, int together, class T>
SILT_DEVICE void apply_group(LinksOfGroup<T> links, GroupStep<T> step, LinkSums& sums, const Team& member) {
  using L = Lanes<T>;
  const int count = int(links.group.count);
  constexpr int some = together * L::count;
  for (int first = some * member.lane; first < count; first += some * member.size) {
    typename L::Real passed[together];
    typename L::Whole back[together];
    for (int k = 0; k < together; ++k)
      if (const int l = first + k * L::count; l < count) {
        const Places<T> at = links.at(l);
        const ComputedSlots<scheme, T> slots{links.slots, at};
        const LinkAt<scheme, T> link{links, l, at, slots, links.distance.at(l)};
        passed[k] = step.template apply<scheme>(link, L::below(count - l)), back[k] = slots(back_row);
      }
    for (int k = 0; k < together; ++k)
      if (const int l = first + k * L::count; l < count)
        scatter<T>(links.corner, back[k], passed[k], count - l);
  }
  step.sums.add_to(sums, [&](std::int64_t term, std::int64_t& sum) { member.add(term, sum); });
  member.add(step.sums.in_range() ? 0 : 1, sums.invalid);
}

/// Corrects the populations that a member's share of a group returned, for an increment of the velocity.
template <class T>
SILT_DEVICE void correct_group(LinksOfGroup<T> links, const Motion<T>& increment, const Team& member) {
  using L = Lanes<T>;
  const int count = int(links.group.count);
  for (int l = L::count * member.lane; l < count; l += L::count * member.size) {
    const Places<T> at = links.at(l);
    const auto back = at.slots(links.slots.back);
    scatter<T>(links.corner, back, corrected<T>(L::gather(links.corner, back), at, increment), count - l);
  }
}

}  // namespace silt::lbm::SILT_BUILD

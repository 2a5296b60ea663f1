#pragma once
// The exchange along the links of one group, with the populations of their block: for the kernels of the
// processor and the passes of devices (SILT_BUILD), a vector of links at a time, or one (SILT_SCALAR).
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
  SILT_DEVICE typename Lanes<T>::Whole back(const Places<T>& at) const { return at.slots(slots.back); }
  SILT_DEVICE SlotsBehind<typename Lanes<T>::Whole> behind(const Places<T>& at) const {
    return {at.slots(slots.out), back(at), Lanes<T>::look_up(slots.step, at.direction)};
  }
};

/// Writes the values of the first `count` links of a vector.
template <class T>
SILT_DEVICE void scatter(T* to, const typename Lanes<T>::Whole& slots, const typename Lanes<T>::Real& values,
                         int count) {
  if (count >= Lanes<T>::count) return Lanes<T>::scatter(to, slots, values);
  for (int k = 0; k < count; ++k) to[lane_of(slots, k)] = lane_of(values, k);
}

/// A vector of links, from the l-th one of a group on.
template <WallScheme scheme, class T>
struct LinkAt {
  using L = Lanes<T>;
  using V = typename L::Real;
  const LinksOfGroup<T>& links;
  int l;
  Places<T> at;
  V q;

  SILT_DEVICE LinkAt(const LinksOfGroup<T>& links, int l)
      : links(links), l(l), at(links.at(l)), q(links.distance.at(l)) {}
  SILT_DEVICE V operator()(int row) const {
    if constexpr (scheme == WallScheme::single_cell_gap)
      if (row > out_row) return L::gather(links.corner, at.cell + links.slots.out[row - out_row]);
    if (row == out_row) return L::gather(links.corner, at.slots(links.slots.out));
    return L::gather(links.corner, row == behind_row ? links.behind(at).behind : links.behind(at).against);
  }
  /// Reads the pair beyond from the block, or from its pairs across.
  SILT_DEVICE BeyondPair<V> beyond() const {
    const SlotsBehind slots = links.behind(at);
    if (!links.group.across)
      return {L::gather(links.corner, slots.away), L::gather(links.corner, slots.toward)};
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

/// Prefetches nothing.
struct NoFetch {
  SILT_DEVICE void operator()(int) const {}
};

/// Applies a member's share of a group, `together` vectors of links at a time: reads them all before it
/// writes. Calls fetch(l) before it reads the links from l on.
template <WallScheme scheme, int together, class T, class Fetch>
SILT_DEVICE void apply_group(const LinksOfGroup<T>& links, GroupStep<T> step, LinkSums& sums,
                             const Team& member, Fetch&& fetch) {
  using L = Lanes<T>;
  const int count = int(links.group.count);
  constexpr int some = together * L::count;
  for (int first = some * member.lane; first < count; first += some * member.size) {
    typename L::Real passed[together];
    typename L::Whole back[together];
    for (int k = 0; k < together; ++k)
      if (const int l = first + k * L::count; l < count) {
        fetch(l);
        const LinkAt<scheme, T> link(links, l);
        passed[k] = step.template apply<scheme>(link, L::below(count - l)), back[k] = links.back(link.at);
      }
    for (int k = 0; k < together; ++k)
      if (const int l = first + k * L::count; l < count) scatter(links.corner, back[k], passed[k], count - l);
  }
  step.sums.add_to(sums, [&](std::int64_t term, std::int64_t& sum) { member.add(term, sum); });
  member.add(step.sums.in_range() ? 0 : 1, sums.invalid);
}

/// Corrects the populations that a member's share of a group returned, for an increment of the velocity.
template <class T, class Fetch>
SILT_DEVICE void correct_group(const LinksOfGroup<T>& links, const Motion<T>& increment, const Team& member,
                               Fetch&& fetch) {
  using L = Lanes<T>;
  const int count = int(links.group.count);
  for (int l = L::count * member.lane; l < count; l += L::count * member.size) {
    fetch(l);
    const Places<T> at = links.at(l);
    const auto back = links.back(at);
    scatter(links.corner, back, corrected<T>(L::gather(links.corner, back), at, increment), count - l);
  }
}

}  // namespace silt::lbm::SILT_BUILD

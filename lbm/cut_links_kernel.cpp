// The pass over cut links, built once an instruction set. A vector of links at a time: place, gather,
// formula, scatter, sums, all in registers (groups are padded to whole vectors).
#include <algorithm>
#include <cmath>

#include "lbm/link_exchange.hpp"
#include "lbm/link_fetch.hpp"

namespace silt::lbm::SILT_ISA {
namespace {

template <class T>
using LinkRows = typename LinkFetch<T>::Rows;

/// The populations that a vector of links reads: rows of slots from the slot of the group's corner on, and
/// the pair beyond, in the block or, by its index, among the block's pairs across.
template <class T>
struct Read {
  const T* data;
  LinkRows<T> rows;
  const std::uint32_t* across;  // null: in the block
  const BeyondPair<T>* pairs;

  auto operator()(int row) const { return Lanes<T>::gather(data, rows[row]); }
  BeyondPair<typename Lanes<T>::Real> beyond() const {
    if (!across) return {(*this)(away_row), (*this)(toward_row)};
    BeyondPair<typename Lanes<T>::Real> found;
    for (int l = 0; l < Lanes<T>::count; ++l)
      found.away[l] = pairs[across[l]].away, found.toward[l] = pairs[across[l]].toward;
    return found;
  }
};

/// Where the excess of a group's links goes.
template <class T>
struct ExcessOfGroup {
  using L = Lanes<T>;
  using V = typename L::Real;
  ExcessQuanta<T>* cells;  // from the group's corner on
  const LinkSlots& slots;
  const T given_behind;
  ExcessQuanta<T>* across;    // of the block's pairs
  const std::uint32_t* pair;  // of the group's links; null: the cells behind lie in the block
  ExcessLanes<T> besides;     // that each link gives

  ExcessOfGroup(const GroupInBlock<T>& here, const SurfaceMotion& motion)
      : cells(here.block.excess() + here.block.cell(here.group.corner)),
        slots(here.slots),
        given_behind(here.links.fluid.given_behind()),
        across(here.excess_across),
        pair(here.group.across ? here.links.across.data() + here.group.across_begin : nullptr),
        besides(ExcessLanes<T>{} + ExcessQuanta<T>(motion.mass_by_link)) {}

  /// So many links of the vector, which begins with the group's l-th, are counted.
  template <WallScheme scheme>
  [[gnu::always_inline]] void add(const V& excess, const Places<T>& at, int l, int links) const {
    const auto counted = L::below(links);
    const V of_counted = counted ? excess : V{};
    ExcessLanes<T> own = excess_quanta<T>(of_counted) - (counted ? besides : ExcessLanes<T>{});
    if constexpr (reads_beyond(scheme)) {
      if (given_behind != 0) {
        const ExcessLanes<T> behind = excess_quanta<T>(V(given_behind * of_counted));
        own -= behind;
        if (!pair) add_to(at.cell - L::look_up(slots.step, at.direction), behind);
        for (int k = 0; pair && k < L::count && k < links; ++k) across[pair[l + k]] += behind[k];
      }
    }
    add_to(at.cell, own);
  }

 private:
  /// Lane by lane: links of several directions, side by side in a vector, share cells.
  [[gnu::always_inline]] void add_to(const typename L::Whole& cell, const ExcessLanes<T>& quanta) const {
    std::int32_t at[L::count];
    ExcessQuanta<T> of[L::count];
    store(at, cell), store(of, quanta);
#pragma GCC unroll 16
    for (int l = 0; l < L::count; ++l) cells[at[l]] += of[l];
  }
};

template <WallScheme scheme, class T>
void apply(const GroupInBlock<T>& here, const SurfaceMotion& motion, ForceForm form, LinkSums& sums,
           LinkFetch<T>& fetch) {
  using L = Lanes<T>;
  const auto& [block, slots, links, group, next, pairs, listed, far, excess_across] = here;
  const SurfaceFrame& frame = links.frame;
  const Motion<T> u(motion);
  const PlaceOrigin<T> origin(block, group.corner, frame);
  const std::uint32_t* const place = links.place.data() + group.begin;
  const WallDistances<T> distance(links, group);
  const int count = int(group.count);
  T* const data = block.data() + block.middle() + block.cell(group.corner);
  const ExcessOfGroup<T> excess(here, motion);
  GroupSums<T> total(form == ForceForm::galilean ? T(1) : T(0), T(largest_exchange(frame.reach, motion)));
  int l = 0;
  for (; l < count; l += L::count) {
    const LinkRows<T> rows = fetch.at(l);
    const Places<T> at(place + l, origin);
    const auto q = distance.at(l);
    const auto ux = u.x(at.r[1], at.r[2]), uy = u.y(at.r[2], at.r[0]), uz = u.z(at.r[0], at.r[1]);
    OppositeWall<typename L::Real> opposite;
    if constexpr (scheme == WallScheme::single_cell_gap) {
      if (!links.opposite_q.empty()) {
        opposite.q = load<typename L::Real>(links.opposite_q.data() + group.opposite + l);
        opposite.u = load<typename L::Real>(links.opposite_u.data() + group.opposite + l);
      }
    }
    const std::uint32_t* const across = group.across ? links.across.data() + group.across_begin + l : nullptr;
    const Exchange<T> e = exchange<scheme>(Read<T>{data, rows, across, pairs}, links.fluid, at, q,
                                           at.along(ux, uy, uz), opposite);
    const auto counted = L::below(count - l);
    L::scatter(data, rows[back_row], e.back);
    excess.template add<scheme>(e.excess, at, l, count - l);
    total.add(e, counted, at, ux, uy, uz);
  }
  fetch.finish(l);
  total.add_to(sums, [](std::int64_t term, std::int64_t& sum) { sum += term; });
  if (!total.in_range()) sums.invalid = true;
}

template <class T>
void correct(const GroupInBlock<T>& here, const SurfaceMotion& increment, LinkFetch<T>& fetch) {
  using L = Lanes<T>;
  const LinkGroup& group = here.group;
  const Motion<T> u(increment);
  const PlaceOrigin<T> origin(here.block, group.corner, here.links.frame);
  const std::uint32_t* const place = here.links.place.data() + group.begin;
  const int count = int(group.count);
  T* const data = here.block.data() + here.block.middle() + here.block.cell(group.corner);
  int l = 0;
  for (; l < count; l += L::count) {
    const std::int32_t* const slot = fetch.at(l)[back_row];
    const Places<T> at(place + l, origin);
    L::scatter(data, slot, corrected(L::gather(data, slot), at, u));
  }
  fetch.finish(l);
}

template <class T>
void apply_group(const GroupInBlock<T>& here, const SurfaceMotion& motion, ForceForm form, LinkSums& sums) {
  ListedLinks own;
  LinkFetch<T> fetch(here, Wanted::all, here.listed ? *here.listed : own);
  with_scheme(here.group.scheme, [&](auto scheme) { apply<scheme()>(here, motion, form, sums, fetch); });
}

template <class T>
void correct_group(const GroupInBlock<T>& here, const SurfaceMotion& increment) {
  ListedLinks own;
  LinkFetch<T> fetch(here, Wanted::returned, here.listed ? *here.listed : own);
  correct(here, increment, fetch);
}

}  // namespace

template <class T>
LinkKernels<T> link_kernels() {
  return {apply_group<T>, correct_group<T>};
}
template LinkKernels<float> link_kernels();
template LinkKernels<double> link_kernels();

}  // namespace silt::lbm::SILT_ISA

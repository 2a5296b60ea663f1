// The pass over cut links, built once per instruction set. Handles a vector of links at a time in registers:
// place, gather, formula, scatter, sums (groups are padded to whole vectors).
#include <algorithm>
#include <cmath>

#include "lbm/walls/link_exchange.hpp"
#include "lbm/walls/link_fetch.hpp"

namespace silt::lbm::SILT_BUILD {
namespace {

template <class T>
using LinkRows = typename LinkFetch<T>::Rows;

/// A vector of links; slots count from that of the group's corner.
template <WallScheme scheme, class T>
struct LinksAt {
  using L = Lanes<T>;
  using V = typename L::Real;
  const GroupInBlock<T>& here;
  const T* data;  // at the group's corner, as `excess`
  ExcessQuanta<T>* excess;
  int l;
  LinkRows<T> rows;
  Places<T> at;
  V q;

  V operator()(int row) const { return L::gather(data, rows[row]); }
  /// Reads the pair beyond from the block, or from its pairs across.
  BeyondPair<V> beyond() const {
    const LinkGroup& group = here.group;
    if (!group.across) return {(*this)(away_row), (*this)(toward_row)};
    const std::uint32_t* const across = here.links.across.data() + group.across_begin + l;
    BeyondPair<V> found;
    for (int k = 0; k < L::count; ++k)
      found.away[k] = here.pairs_across[across[k]].away,
      found.toward[k] = here.pairs_across[across[k]].toward;
    return found;
  }
  OppositeWall<V> opposite() const {
    if (scheme != WallScheme::single_cell_gap || here.links.opposite_q.empty()) return {};
    return {load<V>(here.links.opposite_q.data() + here.group.opposite + l),
            load<V>(here.links.opposite_u.data() + here.group.opposite + l)};
  }
  /// Adds lane by lane, since links of several directions in one vector may share a cell.
  [[gnu::always_inline]] void give(const ExcessLanes<T>& given) const {
    ExcessQuanta<T> of[L::count];
    store(of, given);
    const std::int32_t* const cell = rows[cell_row];
#pragma GCC unroll 16
    for (int k = 0; k < L::count; ++k) excess[cell[k]] += of[k];
  }
};

template <WallScheme scheme, class T>
void apply(const GroupInBlock<T>& here, const SurfaceMotion& motion, ForceForm form, LinkSums& sums,
           LinkFetch<T>& fetch) {
  using L = Lanes<T>;
  const auto& [block, slots, links, group, next, pairs, listed, far] = here;
  const PlaceOrigin<T> origin(block, group.corner, links.frame);
  const std::uint32_t* const place = links.place.data() + group.begin;
  const WallDistances<T> distance(links, group);
  const int count = int(group.count);
  T* const data = block.data() + block.middle() + block.cell(group.corner);
  ExcessQuanta<T>* const excess = block.excess() + block.cell(group.corner);
  GroupStep<T> step(motion, links.fluid, form == ForceForm::galilean,
                    largest_exchange(links.frame.reach, motion));
  int l = 0;
  for (; l < count; l += L::count) {
    const LinkRows<T> rows = fetch.at(l);
    const LinksAt<scheme, T> at{here, data, excess, l, rows, Places<T>(place + l, origin), distance.at(l)};
    const auto back = step.template apply<scheme>(at, L::below(count - l));
    L::scatter(data, rows[back_row], back);
  }
  fetch.finish(l);
  step.sums.add_to(sums, [](std::int64_t term, std::int64_t& sum) { sum += term; });
  if (!step.sums.in_range()) sums.invalid = 1;
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

}  // namespace silt::lbm::SILT_BUILD

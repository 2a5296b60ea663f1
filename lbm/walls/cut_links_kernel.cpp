// The pass over cut links, built once an instruction set. A vector of links at a time: place, gather,
// formula, scatter, sums, all in registers (groups are padded to whole vectors).
#include <algorithm>
#include <cmath>

#include "lbm/walls/link_exchange.hpp"
#include "lbm/walls/link_fetch.hpp"

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

/// The excess of a group's links goes to their cells, lane by lane: links of several directions, side by side
/// in a vector, share cells.
template <class T>
class ExcessOfGroup {
 public:
  using L = Lanes<T>;
  using V = typename L::Real;
  ExcessOfGroup(const GroupInBlock<T>& here, const SurfaceMotion& motion)
      : cells_(here.block.excess() + here.block.cell(here.group.corner)),
        besides_(ExcessLanes<T>{} + ExcessQuanta<T>(motion.mass_by_link)) {}

  [[gnu::always_inline]] void add(const V& excess, const typename L::Mask& counted,
                                  const std::int32_t* cell) const {
    const ExcessLanes<T> own = excess_quanta<T>(excess) - besides_, given = counted ? own : ExcessLanes<T>{};
    ExcessQuanta<T> of[L::count];
    store(of, given);
#pragma GCC unroll 16
    for (int l = 0; l < L::count; ++l) cells_[cell[l]] += of[l];
  }

 private:
  ExcessQuanta<T>* cells_;  // from the group's corner on
  ExcessLanes<T> besides_;  // that each link gives
};

template <WallScheme scheme, class T>
void apply(const GroupInBlock<T>& here, const SurfaceMotion& motion, ForceForm form, LinkSums& sums,
           LinkFetch<T>& fetch) {
  using L = Lanes<T>;
  const auto& [block, slots, links, group, next, pairs, listed, far] = here;
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
    excess.add(e.excess, counted, rows[cell_row]);
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

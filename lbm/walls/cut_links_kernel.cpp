// The pass over cut links, built once per instruction set. Handles a vector of links at a time in registers:
// place, gather, formula, scatter, sums (groups are padded to whole vectors).
#include <algorithm>
#include <cmath>

#include "cpu/prefetch.hpp"
#include "lbm/walls/link_exchange.hpp"

namespace silt::lbm::SILT_BUILD {

template <class T>
PlaceOrigin<T> origin_of(const Block<T>& block, Int3 corner, const SurfaceFrame& frame) {
  return {corner, frame, components<D3Q19>.packed, std::int32_t(block.row_stride()),
          std::int32_t(block.plane_stride())};
}

/// The slots that a kernel needs of a link: all that a scheme reads and writes, or only that of the result.
enum class Wanted { all, returned };

/// Lists the slots of links one window of vectors ahead of use: the next window of a group and, at its end,
/// the first window of the next group. Prefetches populations that are not cached, since links would
/// otherwise spend most of their time waiting for memory.
template <class T>
class LinkFetch {
 public:
  using L = Lanes<T>;
  using Whole = typename L::Whole;

  LinkFetch(const GroupInBlock<T>& here, Wanted wanted, ListedLinks& listed)
      : block_(here.block),
        slots_(here.slots),
        present_{&here.links, &here.group},
        next_(here.next),
        wanted_(wanted),
        fetches_(here.far),
        listed_(listed) {
    if (listed_.group != &here.group) list(present_, 0);
  }

  /// The slots of a vector of links, row by row, counted from the slot of the group's corner. at() must be
  /// called for successive vectors.
  class Rows {
   public:
    explicit Rows(const std::int32_t* first) : first_(first) {}
    const std::int32_t* operator[](int row) const { return first_ + row * L::count; }

   private:
    const std::int32_t* first_;
  };
  Rows at(int l) {
    const int in_window = l % window;
    if (in_window == 0) turn(l);
    if (fetches_) fetch(in_window);
    return Rows(present_slots_ + in_window * present_rows_);
  }
  /// Call after the last vector; `l` is the index after it.
  void finish(int l) {
    for (int k = l % window; fetches_ && k > 0 && k < listed_.count; k += L::count) fetch(k);
  }

 private:
  static constexpr int window = 8 * L::count;
  static_assert(window <= ListedLinks::most);

  /// Makes the window listed ahead the present one, and lists the next.
  void turn(int l) {
    present_slots_ = listed_.slot[listed_.half], present_rows_ = listed_.rows;
    listed_.half = 1 - listed_.half;
    if (l + window < int(present_.group->count))
      list(present_, l + window);
    else if (next_.group)
      list(next_, 0);
    else
      listed_.group = nullptr, listed_.count = 0;
  }

  void list(const NextGroup<T>& links, int first) {
    const LinkGroup& group = *links.group;
    const PlaceOrigin<T> origin = origin_of(block_, group.corner, links.links->frame);
    const std::uint32_t* const place = links.links->place.data() + group.begin + first;
    corner_ = block_.data() + block_.middle() + block_.cell(group.corner);
    listed_.group = &group, listed_.count = std::min(window, int(group.count) - first);
    std::int32_t* const start = listed_.slot[listed_.half];
    std::int32_t* end = start;
    for (int l = 0; l < listed_.count; l += L::count) {
      const Places<T> at(place + l, origin);
      const auto add = [&](const Whole& slots) {
        __builtin_memcpy(end, &slots, sizeof slots);
        end += L::count;
      };
      const Whole back = at.slots(slots_.back);
      add(back);
      if (wanted_ == Wanted::all) add_read(group, at, back, add);
      if (l == 0) listed_.rows = int(end - start) / L::count;
    }
  }

  template <class Add>
  void add_read(const LinkGroup& group, const Places<T>& at, const Whole& back, Add&& add) const {
    const WallScheme scheme = group.scheme;
    const Whole out = at.slots(slots_.out);
    add(at.cell);
    add(out);
    if (scheme == WallScheme::single_cell_gap) {
      for (int i = 1; i < D3Q19::directions; ++i) add(at.cell + slots_.out[i]);
    } else if (reads_behind(scheme)) {
      const SlotsBehind<Whole> slots(out, back, L::look_up(slots_.step, at.direction));
      add(slots.behind);
      add(slots.against);
      if (!reads_beyond(scheme) || group.across) return;
      add(slots.away);
      add(slots.toward);
    }
  }

  /// Prefetches the populations of the listed vector at k with its padding lanes: testing lanes would take
  /// longer. The dense pass has just read the excess of the cells.
  void fetch(int k) const {
    if (k >= listed_.count) return;
    const Rows rows(listed_.slot[listed_.half] + k * listed_.rows);
    for (int row = 0; row < listed_.rows; ++row)
      if (row != cell_row) fetch(corner_, rows[row]);
  }
  template <class Value>
  static void fetch(const Value* from, const std::int32_t* at) {
#pragma GCC unroll 16
    for (int l = 0; l < L::count; ++l) prefetch_to_write(from + at[l]);
  }

  Block<T>& block_;
  const LinkSlots& slots_;
  NextGroup<T> present_, next_;
  Wanted wanted_;
  bool fetches_;
  ListedLinks& listed_;
  const T* corner_ = nullptr;  // of the window listed ahead
  const std::int32_t* present_slots_ = nullptr;
  int present_rows_ = 0;
};

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
  const PlaceOrigin<T> origin = origin_of(block, group.corner, links.frame);
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
    if constexpr (scheme == WallScheme::single_cell_gap)  // the walls on the other side are not padded
      scatter(data, load<typename L::Whole>(rows[back_row]), back, count - l);
    else
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
  const PlaceOrigin<T> origin = origin_of(here.block, group.corner, here.links.frame);
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
void apply_links(const GroupInBlock<T>& here, const SurfaceMotion& motion, ForceForm form, LinkSums& sums) {
  ListedLinks own;
  LinkFetch<T> fetch(here, Wanted::all, here.listed ? *here.listed : own);
  with_scheme(here.group.scheme, [&](auto scheme) { apply<scheme()>(here, motion, form, sums, fetch); });
}

template <class T>
void correct_links(const GroupInBlock<T>& here, const SurfaceMotion& increment) {
  ListedLinks own;
  LinkFetch<T> fetch(here, Wanted::returned, here.listed ? *here.listed : own);
  correct(here, increment, fetch);
}

}  // namespace

template <class T>
LinkKernels<T> link_kernels() {
  return {apply_links<T>, correct_links<T>};
}
template LinkKernels<float> link_kernels();
template LinkKernels<double> link_kernels();

}  // namespace silt::lbm::SILT_BUILD

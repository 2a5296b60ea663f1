// The pass over cut links, built once per instruction set: a vector of links at a time in registers (groups
// are padded to whole vectors).
#include <algorithm>

#include "cpu/prefetch.hpp"
#include "lbm/walls/group_exchange.hpp"

namespace silt::lbm::SILT_BUILD {

namespace {

constexpr Team alone{0, 1};

template <class T>
PlaceOrigin<T> origin_of(const Block<T>& block, Int3 corner, const SurfaceFrame& frame) {
  return {corner, frame, components<D3Q19>.packed, std::int32_t(block.row_stride()),
          std::int32_t(block.plane_stride())};
}

/// Slots of a vector of links, listed before.
template <class T>
struct ListedSlots {
  using L = Lanes<T>;
  static constexpr bool are_padded = true;
  const std::int32_t* first;
  typename L::Whole operator()(int row) const { return load<typename L::Whole>(first + row * L::count); }
  const std::int32_t* cells() const { return first + cell_row * L::count; }
};

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

  /// Returns the slots of the l-th link on. Must be called for successive vectors.
  template <WallScheme>
  ListedSlots<T> at(int l, const Places<T>&) {
    const int in_window = l % window;
    if (in_window == 0) turn(l);
    if (fetches_) fetch(in_window);
    return {present_slots_ + in_window * present_rows_};
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
    const std::int32_t* const rows = listed_.slot[listed_.half] + k * listed_.rows;
    for (int row = 0; row < listed_.rows; ++row)
      if (row != cell_row) fetch(corner_, rows + row * L::count);
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

template <class T>
LinksOfGroup<T> links_of(const GroupInBlock<T>& here) {
  const LinkGroup& group = here.group;
  const CutLinks<T>& links = here.links;
  const std::ptrdiff_t corner = here.block.cell(group.corner);
  const bool knows_opposite = !links.opposite_q.empty();
  return {group,
          here.slots,
          origin_of(here.block, group.corner, links.frame),
          WallDistances<T>(links, group),
          links.place.data() + group.begin,
          knows_opposite ? links.opposite_q.data() + group.opposite : nullptr,
          knows_opposite ? links.opposite_u.data() + group.opposite : nullptr,
          links.across.data() + group.across_begin,
          here.pairs_across,
          here.block.data() + here.block.middle() + corner,
          here.block.excess() + corner};
}

template <WallScheme scheme, class T>
void apply_in(const GroupInBlock<T>& here, const SurfaceMotion& motion, ForceForm form, LinkSums& sums,
              LinkFetch<T>& fetch) {
  const GroupStep<T> step(motion, here.links.fluid, form == ForceForm::galilean,
                          largest_exchange(here.links.frame.reach, motion));
  apply_group<scheme, 1>(links_of(here), step, sums, alone, fetch);
}

template <class T>
void apply(const GroupInBlock<T>& here, const SurfaceMotion& motion, ForceForm form, LinkSums& sums) {
  ListedLinks own;
  LinkFetch<T> fetch(here, Wanted::all, here.listed ? *here.listed : own);
  with_scheme(here.group.scheme, [&](auto scheme) { apply_in<scheme()>(here, motion, form, sums, fetch); });
  fetch.finish(int(padded(here.group.count)));
}

template <class T>
void correct(const GroupInBlock<T>& here, const SurfaceMotion& increment) {
  ListedLinks own;
  LinkFetch<T> fetch(here, Wanted::returned, here.listed ? *here.listed : own);
  correct_group(links_of(here), Motion<T>(increment), alone, fetch);
  fetch.finish(int(padded(here.group.count)));
}

}  // namespace

template <class T>
LinkKernels<T> link_kernels() {
  return {apply<T>, correct<T>};
}
template LinkKernels<float> link_kernels();
template LinkKernels<double> link_kernels();

}  // namespace silt::lbm::SILT_BUILD

// The pass over cut links, built once per instruction set: a vector of links at a time in registers (groups
// are padded to whole vectors).
#include <algorithm>

#include "cpu/prefetch.hpp"
#include "lbm/walls/group_exchange.hpp"

namespace silt::lbm::SILT_BUILD {

namespace {

constexpr Team alone{0, 1};

template <class T>
[[gnu::always_inline]] inline LinksOfGroup<T> links_of(const GroupInBlock<T>& here, const CutLinks<T>& links,
                                                       const LinkGroup& group) {
  const std::ptrdiff_t corner = here.block.cell(group.corner);
  const bool knows_opposite = !links.opposite_q.empty();
  return {group,
          here.slots,
          {group.corner, links.frame, here.slots.components, std::int32_t(here.block.row_stride()),
           std::int32_t(here.block.plane_stride())},
          WallDistances<T>(links, group),
          links.place.data() + group.begin,
          knows_opposite ? links.opposite_q.data() + group.opposite : nullptr,
          knows_opposite ? links.opposite_u.data() + group.opposite : nullptr,
          links.across.data() + group.across_begin,
          here.pairs_across,
          here.block.data() + here.block.middle() + corner,
          here.block.excess() + corner};
}

/// The populations that are prefetched: all that a scheme reads and writes, or only those that return.
enum class Wanted { all, returned };

/// Prefetches populations that are not cached some vectors ahead of their use, those of the next group at the
/// end of a group, since links would otherwise spend most of their time waiting for memory.
template <class T>
class LinkFetch {
  using L = Lanes<T>;
  using Whole = typename L::Whole;

 public:
  LinkFetch(const GroupInBlock<T>& here, Wanted wanted)
      : own_(links_of(here, here.links, here.group)),
        next_(here.next.group ? links_of(here, *here.next.links, *here.next.group) : own_),
        wanted_(wanted),
        fetches_(here.far),
        end_(here.next.group ? std::min(ahead, int(here.next.group->count)) : 0) {}
  const LinksOfGroup<T>& links() const { return own_; }
  /// Call for successive vectors of links of the group.
  void operator()(int l) {
    if (!fetches_) return;
    if (l + ahead < int(own_.group.count))
      fetch(own_, l + ahead);
    else
      fetch_next();
  }
  void finish() {
    if (!fetches_) return;
    while (fetched_ < end_) fetch_next();
    fetch_listed();
  }

 private:
  static constexpr int ahead = 8 * L::count;  // links

  void fetch_next() {
    if (fetched_ < end_) fetch(next_, fetched_);
    fetched_ += L::count;
  }
  /// Lists the slots of a vector of links, and prefetches the populations listed before: single slots are not
  /// to be had at once from a vector just stored.
  void fetch(const LinksOfGroup<T>& of, int l) {
    fetch_listed();
    corner_ = of.corner, rows_ = 0;
    const WallScheme scheme = of.group.scheme;
    const Places<T> at = of.at(l);
    list(of.back(at));
    if (wanted_ == Wanted::returned) return;
    list(at.slots(of.slots.out));
    if (scheme == WallScheme::single_cell_gap) {
      for (int i = 1; i < D3Q19::directions; ++i) list(at.cell + of.slots.out[i]);
    } else if (reads_behind(scheme)) {
      const SlotsBehind<Whole> slots = of.behind(at);
      list(slots.behind), list(slots.against);
      if (!reads_beyond(scheme) || of.group.across) return;
      list(slots.away), list(slots.toward);
    }
  }
  void list(const Whole& slots) { store(listed_ + L::count * rows_++, slots); }
  /// Prefetches the padding lanes as well: testing lanes would take longer. The dense pass has just read the
  /// excess of the cells.
  void fetch_listed() const {
    for (const std::int32_t* slot = listed_; slot < listed_ + L::count * rows_; slot += L::count)
#pragma GCC unroll 16
      for (int k = 0; k < L::count; ++k) prefetch_to_write(corner_ + slot[k]);
  }

  LinksOfGroup<T> own_, next_;
  Wanted wanted_;
  bool fetches_;
  int fetched_ = 0, end_;  // links of the next group
  const T* corner_ = nullptr;
  int rows_ = 0;
  std::int32_t listed_[L::count * (D3Q19::directions + 1)];
};

template <class T>
void apply(const GroupInBlock<T>& here, const SurfaceMotion& motion, ForceForm form, LinkSums& sums) {
  LinkFetch<T> fetch(here, Wanted::all);
  with_scheme(here.group.scheme, [&](auto scheme) {
    apply_group<scheme(), 1>(fetch.links(),
                             GroupStep<T>(motion, here.links.fluid, form == ForceForm::galilean,
                                          largest_exchange(here.links.frame.reach, motion)),
                             sums, alone, fetch);
  });
  fetch.finish();
}

template <class T>
void correct(const GroupInBlock<T>& here, const SurfaceMotion& increment) {
  LinkFetch<T> fetch(here, Wanted::returned);
  correct_group(fetch.links(), Motion<T>(increment), alone, fetch);
  fetch.finish();
}

}  // namespace

template <class T>
LinkKernels<T> link_kernels() {
  return {apply<T>, correct<T>};
}
template LinkKernels<float> link_kernels();
template LinkKernels<double> link_kernels();

}  // namespace silt::lbm::SILT_BUILD

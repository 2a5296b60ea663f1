#pragma once
// The populations of links fetched ahead of use: a window of vectors ahead in their group, and as that ends,
// the first window of the next group. What memory takes for them passes while links are computed; else most
// of the time of links is waiting.
#include "lbm/link_places.hpp"
#include "lbm/prefetch.hpp"

namespace silt::lbm::SILT_ISA {

/// Of a link either all that a scheme reads and writes is wanted, or only what the surface returns.
enum class Wanted { all, returned };

template <class T>
class LinkFetch {
 public:
  using L = Lanes<T>;

  LinkFetch(const GroupInBlock<T>& here, Wanted wanted)
      : block_(here.block),
        slots_(here.slots),
        present_{&here.links, &here.group},
        next_(here.next),
        wanted_(wanted) {}

  /// Call before a vector of links of the present group, those from l on, is computed.
  void before(int l) {
    if (l % window == 0) prepare(l + window);
    fetch(l % window);
  }
  /// Call after the last; `l` is past it.
  void finish(int l) {
    for (int k = l % window; k > 0 && k < prepared_; k += L::count) fetch(k);
  }

 private:
  static constexpr int window = 8 * L::count, most_rows = directions;

  void prepare(int first) {
    prepared_ = 0;
    if (first < int(present_.group->count))
      list(present_, first);
    else if (next_.group)
      list(next_, 0);
  }

  /// Lists where the populations of a window of links are. The last vector's rows are as short as it.
  void list(const NextGroup<T>& links, int first) {
    const LinkGroup& group = *links.group;
    const PlaceOrigin<T> origin(block_, group.corner, links.links->frame);
    const std::uint32_t* const place = links.links->place.data() + group.begin + first;
    corner_ = block_.data() + block_.middle() + block_.cell(group.corner);
    prepared_ = std::min(window, int(group.count) - first);
    std::int32_t* end = slot_;
    for (int l = 0; l < prepared_; l += L::count) {
      const Places<T> at(place + l, origin);
      const int lanes = std::min(L::count, prepared_ - l);
      const auto add = [&](const typename L::Whole& slots) {
        __builtin_memcpy(end, &slots, sizeof slots);
        end += lanes;
      };
      if (wanted_ == Wanted::all) add_read(group, at, add);
      add(at.slots(slots_.back));
      if (l == 0) a_vector_ = int(end - slot_);
    }
    listed_ = int(end - slot_);
  }

  template <class Add>
  void add_read(const LinkGroup& group, const Places<T>& at, Add&& add) const {
    const WallScheme scheme = group.scheme;
    if (scheme == WallScheme::single_cell_gap) {
      for (int i = 1; i < directions; ++i) add(at.cell + slots_.out[i]);
    } else {
      add(at.slots(slots_.out));
      if (reads_behind(scheme)) {
        add(at.slots(slots_.behind));
        add(at.slots(slots_.against));
      }
      if (reads_beyond(scheme) && !group.across) {
        add(at.slots(slots_.away));
        add(at.slots(slots_.toward));
      }
    }
  }

  void fetch(int k) const {
    if (k >= prepared_) return;
    const int first = k / L::count * a_vector_, end = std::min(first + a_vector_, listed_);
#pragma GCC unroll 16
    for (int n = first; n < end; ++n) prefetch_to_write(corner_ + slot_[n]);
  }

  const Block<T>& block_;
  const LinkSlots& slots_;
  NextGroup<T> present_, next_;
  Wanted wanted_;
  const T* corner_ = nullptr;
  int prepared_ = 0, a_vector_ = 0, listed_ = 0;  // links of the window; slots of a vector and of the window
  std::int32_t slot_[window * most_rows + L::count];  // rows are written whole
};

}  // namespace silt::lbm::SILT_ISA

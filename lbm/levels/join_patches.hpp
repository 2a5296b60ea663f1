#pragma once
// Joins patches of a border between levels that lie beside one another and exchange the same packets: passes
// over few large patches take fewer instructions, and less memory, than over many small ones. A patch only
// goes on where each of its slots is the next element of the same array: joining changes no result.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <vector>

#include "lbm/passes/level_border_patches.hpp"

namespace silt::lbm {

/// Returns, for each block, the first in memory of the blocks that share its array.
template <class Blocks>
std::vector<int> first_in_memory(const Blocks& blocks) {
  std::vector<int> first(blocks.size());
  for (std::size_t begin = 0, end; begin < blocks.size(); begin = end) {
    std::size_t least = end = begin;
    for (; end < blocks.size() && blocks[end].shares_array(blocks[begin]); ++end)
      if (blocks[end].data() < blocks[least].data()) least = end;
    std::fill_n(first.begin() + std::ptrdiff_t(begin), end - begin, int(least));
  }
  return first;
}

/// Pairs and joins the entries of lists.
template <class T>
class PatchJoints {
  using Patches = BorderPatches<T>;
  using Patch = typename Patches::Patch;
  using Extent = typename Patches::Extent;

 public:
  /// Appends a packet or a source, or pairs it with the last one if it is the next element along x.
  static void add(std::pmr::vector<typename Patches::Packet>& packets, std::uint8_t& count,
                  const typename Patches::Packet& one) {
    if (count > 0 && !packets.back().paired && one.corner == (packets.back().corner | 1) &&
        one.corner != packets.back().corner && one.addend == packets.back().addend &&
        is_beside(packets.back().to, one.to))
      packets.back().paired = true;
    else
      packets.push_back(one), ++count;
  }
  static void add(std::pmr::vector<typename Patches::Source>& sources, std::uint8_t& count,
                  const Patch& from) {
    if (count > 0 && !sources.back().paired && is_beside(sources.back().from, from))
      sources.back().paired = true;
    else
      sources.push_back({from}), ++count;
  }

  /// Joins the last explosion of a list, whose packets are the last, to the one before it if it goes on; then
  /// so on with the joined one.
  static void join_explosions(BorderLists<T>& list) {
    while (list.explosions.size() > 1 &&
           (join(list, list.explosions, true) || join(list, list.explosions, false))) {
    }
  }
  /// The same for the last coalescence of a list.
  static void join_coalescences(BorderLists<T>& list) {
    while (list.coalescences.size() > 1 &&
           (join(list, list.coalescences, true) || join(list, list.coalescences, false))) {
    }
  }

 private:
  /// The next patch lies at the end of the rows of the one before it, or behind its last row.
  PatchJoints(const Extent& size, const Extent& next, bool along_rows)
      : size_(size), next_(next), along_rows_(along_rows) {}

  template <class Entries>
  static bool join(BorderLists<T>& list, Entries& entries, bool along_rows) {
    const auto last = entries.back(), first = entries[entries.size() - 2];
    const PatchJoints joint(first.size, last.size, along_rows);
    if (!joint.fits() || !joint.goes_on(list, first, last)) return false;
    drop_parts(list, last), entries.pop_back();
    entries.back().size = joint.whole();
    return true;
  }
  static void drop_parts(BorderLists<T>& list, const typename Patches::Explosion& last) {
    for (int s = 0; s < 2; ++s) drop(list.packets[s], last.packets[s]);
  }
  static void drop_parts(BorderLists<T>& list, const typename Patches::Coalescence& last) {
    for (int s = 0; s < 2; ++s) drop(list.sources[s], last.sources[s]);
    drop(list.taken, last.taken);
  }

  bool fits() const { return along_rows_ ? size_.rows == next_.rows : size_.length == next_.length; }
  Extent whole() const {
    if (along_rows_) return {size_.length + next_.length, size_.rows};
    return {size_.length, size_.rows + next_.rows};
  }
  static bool is_beside(const Patch& patch, const Patch& next) {
    return patch.array == next.array && patch.first + 1 == next.first && patch.step == next.step &&
           patch.pitch == next.pitch;
  }
  bool goes_on(const Patch& patch, const Patch& next) const {
    const std::int64_t way =
        along_rows_ ? std::int64_t{size_.length} * patch.step : std::int64_t{size_.rows} * patch.pitch;
    return patch.array == next.array && patch.step == next.step && patch.pitch == next.pitch &&
           patch.first + way == next.first;
  }
  bool goes_on(const typename Patches::Packet& p, const typename Patches::Packet& next) const {
    return p.corner == next.corner && p.addend == next.addend && p.paired == next.paired &&
           goes_on(p.to, next.to);
  }
  bool goes_on(const typename Patches::Source& s, const typename Patches::Source& next) const {
    return s.paired == next.paired && goes_on(s.from, next.from);
  }
  bool goes_on(const typename Patches::Taken& t, const typename Patches::Taken& next) const {
    return t.factor == next.factor && goes_on(t.above, next.above) && goes_on(t.below, next.below);
  }
  bool goes_on(const BorderLists<T>& list, const typename Patches::Explosion& e,
               const typename Patches::Explosion& next) const {
    bool all = goes_on(e.value, next.value) && e.slope == next.slope && e.in_time == next.in_time &&
               (!e.in_time || goes_on(e.before, next.before));
    for (int d = 0; d < 3; ++d)
      all = all && goes_on(e.above[d], next.above[d]) && goes_on(e.below[d], next.below[d]);
    for (int s = 0; s < 2; ++s) all = all && all_go_on(list.packets[s], e.packets[s], next.packets[s]);
    return all;
  }
  bool goes_on(const BorderLists<T>& list, const typename Patches::Coalescence& c,
               const typename Patches::Coalescence& next) const {
    bool all = goes_on(c.to, next.to) && c.addend == next.addend && c.from_coarse == next.from_coarse &&
               all_go_on(list.taken, c.taken, next.taken);
    for (int s = 0; s < 2; ++s) all = all && all_go_on(list.sources[s], c.sources[s], next.sources[s]);
    return all;
  }
  /// Returns whether the last `count` entries of a list go on from as many before them.
  template <class Entry>
  bool all_go_on(const std::pmr::vector<Entry>& list, std::size_t before, std::size_t count) const {
    if (before != count) return false;
    for (std::size_t k = list.size() - count; k < list.size(); ++k)
      if (!goes_on(list[k - count], list[k])) return false;
    return true;
  }
  template <class Entry>
  static void drop(std::pmr::vector<Entry>& list, std::size_t count) {
    list.erase(list.end() - std::ptrdiff_t(count), list.end());
  }

  Extent size_, next_;
  bool along_rows_;
};

}  // namespace silt::lbm

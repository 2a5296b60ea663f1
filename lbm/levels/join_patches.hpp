#pragma once
// Joins patches of a border between levels that lie beside one another and exchange the same packets: passes
// over few large patches take fewer instructions, and less memory, than over many small ones. A patch only
// goes on where each of its slots is the next element of the same array: joining changes no result.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <utility>
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

/// Pairs and joins the entries of lists. Explosions refer to entries of `carry` here, to what these carry
/// later.
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
  static void join_explosions(BorderLists<T>& list, std::pmr::vector<typename Patches::Carried>& carry) {
    while (list.explosions.size() > 1 && (join(list, carry, true) || join(list, carry, false))) {
    }
  }
  /// The same for the last coalescence of a list.
  static void join_coalescences(BorderLists<T>& list) {
    while (list.coalescences.size() > 1 && (join(list, true) || join(list, false))) {
    }
  }

  /// Makes one row of each patch whose rows are single cells, since passes take several cells of a row at
  /// once. Call when all are joined.
  static void turn_columns(BorderLists<T>& list, std::pmr::vector<typename Patches::Carried>& carry) {
    for (typename Patches::Explosion& one : list.explosions) {
      if (!is_column(one.size)) continue;
      for (int s = 0; s < 2; ++s)
        for (int k = 0; k < one.packets[s]; ++k) turn(list.packets[s][one.first[s] + k].to);
      typename Patches::Carried& its = carry[one.carried];
      turn(its.value), turn(its.before);
      for (int d = 0; d < 3; ++d) turn(its.above[d]), turn(its.below[d]);
      turn(its.size), turn(one.size);
    }
    for (typename Patches::Coalescence& one : list.coalescences) {
      if (!is_column(one.size)) continue;
      for (int s = 0; s < 2; ++s)
        for (int k = 0; k < one.sources[s]; ++k) turn(list.sources[s][one.first[s] + k].from);
      for (int k = 0; k < one.taken; ++k)
        turn(list.taken[one.first_taken + k].above), turn(list.taken[one.first_taken + k].below);
      turn(one.to), turn(one.size);
    }
  }

 private:
  static bool is_column(const Extent& size) { return size.length == 1 && size.rows > 1; }
  static void turn(Extent& size) { std::swap(size.length, size.rows); }
  static void turn(Patch& patch) { std::swap(patch.step, patch.pitch); }

  /// The next patch lies at the end of the rows of the one before it, or behind its last row.
  PatchJoints(const Extent& size, const Extent& next, bool along_rows)
      : size_(size), next_(next), along_rows_(along_rows) {}

  static bool join(BorderLists<T>& list, std::pmr::vector<typename Patches::Carried>& carry,
                   bool along_rows) {
    const typename Patches::Explosion last = list.explosions.back(),
                                      first = list.explosions[list.explosions.size() - 2];
    const PatchJoints joint(first.size, last.size, along_rows);
    if (!joint.fits() || first.carried + 2 != carry.size() ||
        !joint.goes_on(carry[first.carried], carry.back()))
      return false;
    for (int s = 0; s < 2; ++s)
      if (!joint.all_go_on(list.packets[s], first.packets[s], last.packets[s])) return false;
    for (int s = 0; s < 2; ++s) drop(list.packets[s], last.packets[s]);
    list.explosions.pop_back(), carry.pop_back();
    list.explosions.back().size = carry.back().size = joint.whole();
    return true;
  }
  static bool join(BorderLists<T>& list, bool along_rows) {
    const typename Patches::Coalescence last = list.coalescences.back(),
                                        first = list.coalescences[list.coalescences.size() - 2];
    const PatchJoints joint(first.size, last.size, along_rows);
    if (!joint.fits() || !joint.goes_on(first.to, last.to) || first.addend != last.addend ||
        first.from_coarse != last.from_coarse || !joint.all_go_on(list.taken, first.taken, last.taken))
      return false;
    for (int s = 0; s < 2; ++s)
      if (!joint.all_go_on(list.sources[s], first.sources[s], last.sources[s])) return false;
    for (int s = 0; s < 2; ++s) drop(list.sources[s], last.sources[s]);
    drop(list.taken, last.taken), list.coalescences.pop_back();
    list.coalescences.back().size = joint.whole();
    return true;
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
  bool goes_on(const typename Patches::Carried& c, const typename Patches::Carried& next) const {
    bool all = goes_on(c.value, next.value) && c.slope == next.slope && c.change == next.change &&
               (!c.in_time() || goes_on(c.before, next.before));
    for (int d = 0; d < 3; ++d)
      all &= goes_on(c.above[d], next.above[d]) && goes_on(c.below[d], next.below[d]);
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

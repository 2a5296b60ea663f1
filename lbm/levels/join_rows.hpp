#pragma once
// Joins rows of a border between levels that lie one behind the other and exchange the same packets: passes
// over few long rows take fewer instructions, and less memory, than over many short ones. A row only goes on
// where each of its slots, and each value it carries, is the next element of the same array: joining changes
// no result.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <vector>

#include "lbm/passes/level_border_rows.hpp"

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
class RowJoints {
  using Rows = BorderRows<T>;
  using Row = typename Rows::Row;

 public:
  /// Appends a packet or a source, or pairs it with the last one if it is the next element along x.
  static void add(std::pmr::vector<typename Rows::Packet>& packets, std::uint8_t& count,
                  const typename Rows::Packet& one) {
    if (count > 0 && !packets.back().paired && one.corner == (packets.back().corner | 1) &&
        one.corner != packets.back().corner && one.addend == packets.back().addend &&
        is_beside(packets.back().to, one.to))
      packets.back().paired = true;
    else
      packets.push_back(one), ++count;
  }
  static void add(std::pmr::vector<typename Rows::Source>& sources, std::uint8_t& count, const Row& from) {
    if (count > 0 && !sources.back().paired && is_beside(sources.back().from, from))
      sources.back().paired = true;
    else
      sources.push_back({from}), ++count;
  }

  /// Joins the last explosion of a list, whose packets are the last, to the one before it if it goes on.
  static void join_explosions(BorderLists<T>& list, std::pmr::vector<typename Rows::Carried>& carry) {
    if (list.explosions.size() < 2) return;
    const typename Rows::Explosion last = list.explosions.back();
    typename Rows::Explosion& first = list.explosions[list.explosions.size() - 2];
    if (first.carried + 2 != carry.size() || !goes_on(carry[first.carried], carry.back(), first.length))
      return;
    for (int s = 0; s < 2; ++s)
      if (!all_go_on(list.packets[s], first.packets[s], last.packets[s], first.length)) return;
    carry[first.carried].length = first.length += last.length;
    for (int s = 0; s < 2; ++s) drop(list.packets[s], last.packets[s]);
    list.explosions.pop_back(), carry.pop_back();
  }

  /// The same for the last coalescence of a list.
  static void join_coalescences(BorderLists<T>& list) {
    if (list.coalescences.size() < 2) return;
    const typename Rows::Coalescence last = list.coalescences.back();
    typename Rows::Coalescence& first = list.coalescences[list.coalescences.size() - 2];
    if (!goes_on(first.to, last.to, first.length) || first.sum + first.length != last.sum ||
        first.addend != last.addend || first.from_coarse != last.from_coarse ||
        !all_go_on(list.taken, first.taken, last.taken, first.length))
      return;
    for (int s = 0; s < 2; ++s)
      if (!all_go_on(list.sources[s], first.sources[s], last.sources[s], first.length)) return;
    first.length += last.length;
    for (int s = 0; s < 2; ++s) drop(list.sources[s], last.sources[s]);
    drop(list.taken, last.taken), list.coalescences.pop_back();
  }

 private:
  static bool is_beside(const Row& row, const Row& next) {
    return row.array == next.array && row.first + 1 == next.first && row.step == next.step;
  }
  /// Return whether `next` goes on where `cells` cells of a row end.
  static bool goes_on(const Row& row, const Row& next, std::int64_t cells) {
    return row.array == next.array && row.step == next.step && row.first + cells * row.step == next.first;
  }
  static bool goes_on(const typename Rows::Packet& p, const typename Rows::Packet& next, std::int64_t cells) {
    return p.corner == next.corner && p.addend == next.addend && p.paired == next.paired &&
           goes_on(p.to, next.to, cells);
  }
  static bool goes_on(const typename Rows::Source& s, const typename Rows::Source& next, std::int64_t cells) {
    return s.paired == next.paired && goes_on(s.from, next.from, cells);
  }
  static bool goes_on(const typename Rows::Taken& t, const typename Rows::Taken& next, std::int64_t cells) {
    return t.factor == next.factor && goes_on(t.above, next.above, cells) &&
           goes_on(t.below, next.below, cells);
  }
  static bool goes_on(const typename Rows::Carried& c, const typename Rows::Carried& next,
                      std::int64_t cells) {
    bool all = goes_on(c.value, next.value, cells) && c.slope == next.slope &&
               (c.before < 0 ? next.before < 0 : c.before + cells == next.before);
    for (int d = 0; d < 3; ++d)
      all &= goes_on(c.above[d], next.above[d], cells) && goes_on(c.below[d], next.below[d], cells);
    return all;
  }
  /// Returns whether the last `count` entries of a list go on from as many before them.
  template <class Entry>
  static bool all_go_on(const std::pmr::vector<Entry>& list, std::size_t before, std::size_t count,
                        std::int64_t cells) {
    if (before != count) return false;
    for (std::size_t k = list.size() - count; k < list.size(); ++k)
      if (!goes_on(list[k - count], list[k], cells)) return false;
    return true;
  }
  template <class Entry>
  static void drop(std::pmr::vector<Entry>& list, std::size_t count) {
    list.erase(list.end() - std::ptrdiff_t(count), list.end());
  }
};

}  // namespace silt::lbm

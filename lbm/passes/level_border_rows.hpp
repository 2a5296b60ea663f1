#pragma once
// Populations cross a border between levels by rows of coarse cells whose surroundings are the same leaves of
// the tree of cuts (level_border.hpp). These are the lists of rows, and the steps for some elements of a row.
// The processor does all of a row at once, a device one element.
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <vector>

#include "cpu/device_code.hpp"

namespace silt::lbm {

template <class T>
struct BorderLists;

template <class T>
struct BorderRows {
  /// Elements of an array of a table, one for each coarse cell of a row. The tables of a fluid have the
  /// arrays of all directions of its blocks, block * directions + i: those of what left, then of what
  /// arrives; then what was fetched from other ranks.
  struct Row {
    std::uint32_t array = 0;
    std::int32_t first = 0, step = 0;
  };
  /// Packets are the values that leave a row of coarse cells along one direction: rows beside one another.
  struct Carried {
    std::uint32_t length, first;  // first: in carried
    Row value;
    std::array<Row, 3> above, below;  // beside it along each axis; itself where no coarse cell is
    std::array<T, 3> slope;           // times their difference: the change to a packet's place
    std::int32_t before;  // in coarse_before, what had arrived in the first cell; -1: does not count
  };
  static constexpr int carried_rows =
      5;  // populations of the first step, of the second; changes along x, y, z
  /// An explosion is that of coarse populations of one direction that left a row of cells, into fine cells.
  struct Explosion {
    std::uint32_t length, carried;
    std::uint32_t first[2];   // of its packets, by sub-step
    std::uint8_t packets[2];  // how many
  };
  struct Packet {
    Row to;
    T addend;             // by walls that it met, and the force
    std::uint8_t corner;  // bit d for the upper half along axis d
    bool paired = false;  // the next element is for the other corner along x
  };
  /// A coalescence is what arrives along one direction in a row of coarse cells.
  struct Coalescence {
    std::uint32_t length;
    Row to;
    std::uint32_t sum;  // in sums, of the first sub-step's
    T addend;
    std::uint32_t first[2], first_taken;  // of its sources, by sub-step
    std::uint8_t from_coarse;             // packets of the eight
    std::uint8_t sources[2], taken;       // how many
  };
  struct Source {  // in fine cells
    Row from;
    bool paired = false;  // the next element is one more
  };
  /// Taken is the difference of packets that entered fine cells from the value in the middle of their cell.
  struct Taken {
    Row above, below;
    T factor;
  };
  /// Packets that pass between two fine cells.
  struct Passing {
    std::uint32_t length;
    Row from, to;
    std::uint32_t kept;  // in sums
    T addend;
  };

  /// The tables, and arrays of this border.
  T *const *fine_left, *const *fine_arriving, *const *coarse_left, *const *coarse_arriving;
  const T* coarse_before;
  T *carried, *sums;
  int sub_step;
  /// The entries that are passed to the functions below refer to these rows.
  const Packet* packets;
  const Source* sources;
  const Taken* taken;
  void refer_to(const BorderLists<T>& lists) {
    packets = lists.packets[sub_step].data(), sources = lists.sources[sub_step].data();
    taken = lists.taken.data();
  }

  /// Calls f(n, element) for elements of a row.
  template <class F>
  [[gnu::always_inline]] SILT_DEVICE static void for_row(T* const* table, const Row& row,
                                                         std::ptrdiff_t begin, std::ptrdiff_t end, F&& f) {
    T* const first = table[row.array] + row.first;
    const std::ptrdiff_t step = row.step;
    if (step == 1) {
#pragma GCC ivdep
      for (std::ptrdiff_t n = begin; n < end; ++n) f(n, first[n]);
    } else {
      for (std::ptrdiff_t n = begin; n < end; ++n) f(n, first[n * step]);
    }
  }
  /// Calls f(n, element, the next one), which are pairs beside one another if the row is along x.
  template <class F>
  [[gnu::always_inline]] SILT_DEVICE static void for_pairs(T* const* table, const Row& row,
                                                           std::ptrdiff_t begin, std::ptrdiff_t end, F&& f) {
    T* const first = table[row.array] + row.first;
    const std::ptrdiff_t step = row.step;
    if (step == 2) {
#pragma GCC ivdep
      for (std::ptrdiff_t n = begin; n < end; ++n) f(n, first[2 * n], first[2 * n + 1]);
    } else {
      for (std::ptrdiff_t n = begin; n < end; ++n) f(n, first[n * step], first[n * step + 1]);
    }
  }

  /// A packet carries the population of its cell in its corner, with a fourth less of what collision has just
  /// added in the first step and a fourth more in the second, as if a fourth of a step later or earlier.
  SILT_DEVICE void carry(const Carried& c, std::ptrdiff_t begin, std::ptrdiff_t end) const {
    T* row[carried_rows];
    for (int k = 0; k < carried_rows; ++k) row[k] = carried + c.first + k * c.length;
    for_row(coarse_left, c.value, begin, end, [&](auto n, T v) { row[0][n] = row[1][n] = v; });
    if (c.before >= 0) {
      const T* const before = coarse_before + c.before;
      for (std::ptrdiff_t n = begin; n < end; ++n) {
        const T fourth = T(0.25) * (before[n] - row[0][n]);
        row[0][n] += fourth, row[1][n] -= fourth;
      }
    }
    for (int d = 0; d < 3; ++d) {
      T* const change = row[2 + d];
      const T slope = c.slope[d];
      for_row(coarse_left, c.above[d], begin, end, [&](auto n, T v) { change[n] = v; });
      for_row(coarse_left, c.below[d], begin, end, [&](auto n, T v) { change[n] = slope * (change[n] - v); });
    }
  }

  SILT_DEVICE void explode(const Explosion& e, std::ptrdiff_t begin, std::ptrdiff_t end) const {
    const T* const its = carried + e.carried;
    const T *const value = its + sub_step * e.length, *const along_x = its + 2 * e.length,
                   *const along_y = along_x + e.length, *const along_z = along_y + e.length;
    T* const* const arrays = fine_arriving;
    const Packet* const first = packets + e.first[sub_step];
    for (const Packet *p = first, *const last = first + e.packets[sub_step]; p != last; ++p) {
      const Packet& packet = *p;
      const auto sign = [&](int d) { return packet.corner >> d & 1 ? T(1) : T(-1); };
      const T x = sign(0), y = sign(1), z = sign(2), addend = packet.addend;
      const auto middle = [&](auto n) { return value[n] + (y * along_y[n] + z * along_z[n]) + addend; };
      if (packet.paired)
        for_pairs(arrays, packet.to, begin, end, [&](auto n, T& low, T& high) {
          const T between = middle(n);
          low = between - along_x[n], high = between + along_x[n];
        });
      else
        for_row(arrays, packet.to, begin, end, [&](auto n, T& to) { to = middle(n) + x * along_x[n]; });
    }
  }

  /// Adds up what arrives; changes nothing else.
  SILT_DEVICE void add_up(const Coalescence& c, std::ptrdiff_t begin, std::ptrdiff_t end) const {
    T* const sum = sums + c.sum;
    if (sub_step == 0)
      for (std::ptrdiff_t n = begin; n < end; ++n) sum[n] = T(0);
    T* const* const arrays = fine_left;
    const Source* const first = sources + c.first[sub_step];
    for (const Source *s = first, *const last = first + c.sources[sub_step]; s != last; ++s) {
      const Source& source = *s;
      if (source.paired)
        for_pairs(arrays, source.from, begin, end,
                  [&](auto n, T low, T high) { sum[n] = sum[n] + low + high; });
      else
        for_row(arrays, source.from, begin, end, [&](auto n, T v) { sum[n] += v; });
    }
    if (sub_step == 0) return;
    if (c.from_coarse > 0)
      for_row(coarse_arriving, c.to, begin, end, [&](auto n, T v) { sum[n] += c.from_coarse * v; });
    for (int k = 0; k < c.taken; ++k) {
      const Taken& t = taken[c.first_taken + k];
      for_row(coarse_left, t.above, begin, end, [&](auto n, T v) { sum[n] -= t.factor * v; });
      for_row(coarse_left, t.below, begin, end, [&](auto n, T v) { sum[n] += t.factor * v; });
    }
  }
  /// Gives coarse cells what was added up in both sub-steps.
  SILT_DEVICE void coalesce(const Coalescence& c, std::ptrdiff_t begin, std::ptrdiff_t end) const {
    if (sub_step == 0) return;
    const T* const sum = sums + c.sum;
    for_row(coarse_arriving, c.to, begin, end, [&](auto n, T& to) { to = sum[n] / 8 + c.addend; });
  }

  SILT_DEVICE void pass(const Passing& p, std::ptrdiff_t begin, std::ptrdiff_t end) const {
    T* const kept = sums + p.kept;
    if (sub_step == 0)
      for_row(fine_left, p.from, begin, end, [&](auto n, T v) { kept[n] = v; });
    else
      for_row(fine_arriving, p.to, begin, end, [&](auto n, T& to) { to = kept[n] + p.addend; });
  }
};

/// Lists of a border, in memory that a device reaches; packets of one explosion follow those of another.
template <class T>
struct BorderLists {
  template <class Entry>
  using Of = std::pmr::vector<Entry>;
  using Rows = BorderRows<T>;
  Of<typename Rows::Explosion> explosions;
  Of<typename Rows::Packet> packets[2];  // by sub-step
  Of<typename Rows::Coalescence> coalescences;
  Of<typename Rows::Source> sources[2];
  Of<typename Rows::Taken> taken;

  explicit BorderLists(std::pmr::memory_resource* m = std::pmr::new_delete_resource())
      : explosions(m),
        packets{Of<typename Rows::Packet>(m), Of<typename Rows::Packet>(m)},
        coalescences(m),
        sources{Of<typename Rows::Source>(m), Of<typename Rows::Source>(m)},
        taken(m) {}
};

}  // namespace silt::lbm

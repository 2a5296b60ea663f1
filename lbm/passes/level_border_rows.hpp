#pragma once
// How populations cross a border between levels (level_border.hpp): lists of rows of coarse cells that have
// the same leaves of the tree of cuts around them, and the steps of the exchange for a range of a row. A CPU
// handles a whole row at once, a device one element per thread.
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
  /// Elements of an array of a table, one per coarse cell of a row. The table of a fluid has arrays of the
  /// populations that left, one per block and direction (block * directions + i), then of those that arrive,
  /// then those fetched from other ranks.
  struct Row {
    std::uint32_t array = 0;
    std::int32_t first = 0, step = 0;
  };
  /// The packets that leave a row of coarse cells along one direction, stored in `carried` row after row.
  struct Carried {
    std::uint32_t length, first;  // first: index in carried
    Row value;
    std::array<Row, 3> above, below;  // neighbours along each axis; the row itself where none is coarse
    std::array<T, 3> slope;           // times above - below: change from the centre to a packet
    std::int32_t before;              // index in coarse_before of arrivals before collision; -1: not used
  };
  static constexpr int carried_rows =
      5;  // values in the first and in the second step; changes along x, y and z
  /// Moves coarse populations of one direction that left a row of cells into fine cells.
  struct Explosion {
    std::uint32_t length, carried;
    std::uint32_t first[2];   // packet, by sub-step
    std::uint8_t packets[2];  // number of packets
  };
  struct Packet {
    Row to;
    T addend;             // from walls on the way, and the force
    std::uint8_t corner;  // bit d for the upper half along axis d
    bool paired = false;  // the next element receives the other corner along x
  };
  /// Sums the packets that arrive along one direction in a row of coarse cells.
  struct Coalescence {
    std::uint32_t length;
    Row to;
    std::uint32_t sum;  // index in sums, kept between sub-steps
    T addend;
    std::uint32_t first[2], first_taken;  // source, by sub-step
    std::uint8_t from_coarse;             // number of the eight packets that come from the coarse cell
    std::uint8_t sources[2], taken;       // numbers of them
  };
  struct Source {  // a row of fine cells
    Row from;
    bool paired = false;  // the next element is a source, too
  };
  /// The difference between packets that entered fine cells and the value at the centre of their coarse cell.
  struct Taken {
    Row above, below;
    T factor;
  };
  /// A packet that passes between two fine cells, through a coarse one.
  struct Passing {
    std::uint32_t length;
    Row from, to;
    std::uint32_t kept;  // index in sums
    T addend;
  };

  /// The tables of both fluids, and the arrays of this border.
  T *const *fine_left, *const *fine_arriving, *const *coarse_left, *const *coarse_arriving;
  const T* coarse_before;
  T *carried, *sums;
  int sub_step;
  /// The lists to which the entries passed to the functions below refer.
  const Packet* packets;
  const Source* sources;
  const Taken* taken;
  void refer_to(const BorderLists<T>& lists) {
    packets = lists.packets[sub_step].data(), sources = lists.sources[sub_step].data();
    taken = lists.taken.data();
  }

  /// Calls f(n, element) for elements [begin, end) of a row.
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
  /// Calls f(n, element, next element): the two fine cells side by side along x.
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

  /// Sets the packets of a row: the coarse population extrapolated to a corner, minus (first step) or plus
  /// (second) a quarter of the change by the last collision, i.e. a quarter of a step later or earlier.
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

  /// Adds the packets of a sub-step to the sums; changes no population.
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
  /// Writes the sums of both sub-steps to the coarse cells.
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

/// The lists of a border, in memory that a device reaches; the packets of an explosion are consecutive.
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

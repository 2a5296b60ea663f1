#include "lbm/level_border.hpp"

#include <algorithm>
#include <span>
#include <utility>

namespace silt::lbm {

namespace {

/// The arrays of all directions of the blocks: what arrives at a parity, or what left.
template <class T, class F>
std::vector<T*> arriving(F& fluid, Parity parity) {
  std::vector<T*> arrays;
  for (auto& block : fluid.blocks())
    for (int i = 0; i < directions; ++i) arrays.push_back(block.data() + block.arriving(i, parity));
  return arrays;
}
template <class T>
std::vector<const T*> left(const Fluid<T>& fluid, Parity parity) {
  std::vector<const T*> arrays;
  for (const auto& block : fluid.blocks())
    for (int i = 0; i < directions; ++i) arrays.push_back(block.data() + block.leaving(i, parity));
  return arrays;
}
template <class T>
std::vector<const T*> left_and_returned(const Fluid<T>& coarse) {
  std::vector<const T*> arrays = left(coarse, coarse.parity());
  const auto returned = arriving<const T>(coarse, coarse.parity());
  arrays.insert(arrays.end(), returned.begin(), returned.end());
  return arrays;
}

template <class T>
void fetch(SlotExchange<T>& slots, const std::vector<const T*>& from, std::vector<T>& to) {
  T* const target[] = {to.data()};
  slots.start(from);
  slots.finish(from, target);
}

/// Calls f(n, element) for elements of a row.
template <class T, class Row, class F>
[[gnu::always_inline]] inline void for_row(T* const* table, const Row& row, std::uint32_t count, F&& f) {
  T* const first = table[row.array] + row.first;
  const std::ptrdiff_t step = row.step;
  if (step == 1) {
#pragma GCC ivdep
    for (std::ptrdiff_t n = 0; n < count; ++n) f(n, first[n]);
  } else {
    for (std::ptrdiff_t n = 0; n < count; ++n) f(n, first[n * step]);
  }
}
/// Calls f(n, element, the next one), which are pairs beside one another if the row is along x.
template <class T, class Row, class F>
[[gnu::always_inline]] inline void for_pairs(T* const* table, const Row& row, std::uint32_t count, F&& f) {
  T* const first = table[row.array] + row.first;
  const std::ptrdiff_t step = row.step;
  if (step == 2) {
#pragma GCC ivdep
    for (std::ptrdiff_t n = 0; n < count; ++n) f(n, first[2 * n], first[2 * n + 1]);
  } else {
    for (std::ptrdiff_t n = 0; n < count; ++n) f(n, first[n * step], first[n * step + 1]);
  }
}

}  // namespace

template <class T>
void LevelBorder<T>::before_coarse_pass() {
  fetch(before_, arriving<const T>(std::as_const(coarse_), coarse_.parity()), coarse_before_);
}

template <class T>
void LevelBorder<T>::after_coarse_pass() {
  now_.coarse_left = left_and_returned(coarse_);
  fetch(coarse_left_, now_.coarse_left, coarse_fetched_);
  now_.coarse_left.push_back(coarse_fetched_.data());
  now_.coarse_arriving = arriving<T>(coarse_, coarse_.parity());
  for (const Carried& row : carry_) carry(row);
}

template <class T>
void LevelBorder<T>::begin_fine_pass() {
  const Parity after = flipped(fine_.parity());
  now_.sub_step = int(fine_.passes() % 2);
  now_.fine_arriving = arriving<T>(fine_, after);
  now_.fine_left = left(fine_, after);
  now_.fine_left.push_back(fine_fetched_[now_.sub_step].data());
  by_parts_.assign(ready_.size(), false);
}

template <class T>
void LevelBorder<T>::after_part(int block, int part) {
  by_parts_[block] = true;
  do_ready(ready_[block][part]);
}

template <class T>
void LevelBorder<T>::end_fine_pass() {
  for (std::size_t b = 0; b < ready_.size(); ++b)
    for (const Ready& part : ready_[b])
      if (!by_parts_[b]) do_ready(part);
  fetch(fine_left_[now_.sub_step], left(fine_, fine_.parity()), fine_fetched_[now_.sub_step]);
  do_ready(late_);
  for (const Passing& p : passing_)
    if (now_.sub_step == 0)
      for_row(now_.fine_left.data(), p.from, p.length, [&](auto n, T v) { sums_[p.kept + n] = v; });
    else
      for_row(now_.fine_arriving.data(), p.to, p.length,
              [&](auto n, T& to) { to = sums_[p.kept + n] + p.addend; });
}

template <class T>
void LevelBorder<T>::do_ready(const Ready& ready) {
  const Packet* packet = ready.packets[now_.sub_step].data();
  for (const Explosion& e : ready.explosions) {
    explode(e, packet);
    packet += e.packets[now_.sub_step];
  }
  const Source* source = ready.sources[now_.sub_step].data();
  const Taken* taken = ready.taken.data();
  for (const Coalescence& c : ready.coalescences) {
    coalesce(c, source, taken);
    source += c.sources[now_.sub_step], taken += c.taken;
  }
}

/// A packet carries the population of its cell in its corner, and of what collision has just added to it a
/// fourth less in the first step or more in the second: as much as it would have had a fourth of a step later
/// or earlier.
template <class T>
void LevelBorder<T>::carry(const Carried& c) {
  const T* const* const table = now_.coarse_left.data();
  T* row[carried_rows];
  for (int k = 0; k < carried_rows; ++k) row[k] = carried_.data() + c.first + k * c.length;
  for_row(table, c.value, c.length, [&](auto n, T v) { row[0][n] = row[1][n] = v; });
  if (const T* const before = coarse_before_.data() + c.before; c.before >= 0)
    for (std::uint32_t n = 0; n < c.length; ++n) {
      const T fourth = T(0.25) * (before[n] - row[0][n]);
      row[0][n] += fourth, row[1][n] -= fourth;
    }
  for (int d = 0; d < 3; ++d) {
    T* const change = row[2 + d];
    for_row(table, c.above[d], c.length, [&](auto n, T v) { change[n] = v; });
    for_row(table, c.below[d], c.length, [&](auto n, T v) { change[n] = c.slope[d] * (change[n] - v); });
  }
}

template <class T>
void LevelBorder<T>::explode(const Explosion& e, const Packet* packets) {
  T* const* const arrays = now_.fine_arriving.data();
  const T* const carried = carried_.data() + e.carried;
  const T *const value = carried + now_.sub_step * e.length, *const along_x = carried + 2 * e.length,
                 *const along_y = along_x + e.length, *const along_z = along_y + e.length;
  for (const Packet& packet : std::span(packets, e.packets[now_.sub_step])) {
    const auto sign = [&](int d) { return packet.corner >> d & 1 ? T(1) : T(-1); };
    const T x = sign(0), y = sign(1), z = sign(2), addend = packet.addend;
    const auto middle = [&](auto n) { return value[n] + (y * along_y[n] + z * along_z[n]) + addend; };
    if (packet.paired)
      for_pairs(arrays, packet.to, e.length, [&](auto n, T& low, T& high) {
        const T between = middle(n);
        low = between - along_x[n], high = between + along_x[n];
      });
    else
      for_row(arrays, packet.to, e.length, [&](auto n, T& to) { to = middle(n) + x * along_x[n]; });
  }
}

template <class T>
void LevelBorder<T>::coalesce(const Coalescence& c, const Source* sources, const Taken* taken) {
  const T* const* const table = now_.fine_left.data();
  T* const* const arrays = now_.coarse_arriving.data();
  T* const sum = sums_.data() + c.sum;
  if (now_.sub_step == 0) std::fill_n(sum, c.length, T(0));
  for (const Source& source : std::span(sources, c.sources[now_.sub_step]))
    if (source.paired)
      for_pairs(table, source.from, c.length, [&](auto n, T low, T high) { sum[n] = sum[n] + low + high; });
    else
      for_row(table, source.from, c.length, [&](auto n, T v) { sum[n] += v; });
  if (now_.sub_step == 0) return;
  if (c.from_coarse > 0) for_row(arrays, c.to, c.length, [&](auto n, T v) { sum[n] += c.from_coarse * v; });
  for (const Taken& t : std::span(taken, c.taken)) {
    for_row(now_.coarse_left.data(), t.above, c.length, [&](auto n, T v) { sum[n] -= t.factor * v; });
    for_row(now_.coarse_left.data(), t.below, c.length, [&](auto n, T v) { sum[n] += t.factor * v; });
  }
  for_row(arrays, c.to, c.length, [&](auto n, T& to) { to = sum[n] / 8 + c.addend; });
}

template void LevelBorder<float>::before_coarse_pass();
template void LevelBorder<float>::after_coarse_pass();
template void LevelBorder<float>::begin_fine_pass();
template void LevelBorder<float>::after_part(int, int);
template void LevelBorder<float>::end_fine_pass();
template void LevelBorder<double>::before_coarse_pass();
template void LevelBorder<double>::after_coarse_pass();
template void LevelBorder<double>::begin_fine_pass();
template void LevelBorder<double>::after_part(int, int);
template void LevelBorder<double>::end_fine_pass();

}  // namespace silt::lbm

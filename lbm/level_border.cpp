#include "lbm/level_border.hpp"

#include <algorithm>
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

constexpr std::uint32_t most = 64;  // cells of a row at a time

/// Calls f(first, count) for the parts of a row.
template <class F>
void in_parts(std::uint32_t length, F&& f) {
  for (std::uint32_t begin = 0; begin < length; begin += most) f(begin, std::min(most, length - begin));
}

/// Calls f(n, element) for elements of a row.
template <class T, class Row, class F>
[[gnu::always_inline]] inline void for_row(T* const* table, const Row& row, std::uint32_t begin,
                                           std::uint32_t count, F&& f) {
  T* const first = table[row.array] + row.first + std::ptrdiff_t(begin) * row.step;
  const std::ptrdiff_t step = row.step;
  if (step == 1)
    for (std::ptrdiff_t n = 0; n < count; ++n) f(n, first[n]);
  else
    for (std::ptrdiff_t n = 0; n < count; ++n) f(n, first[n * step]);
}
/// Calls f(n, element, the next one), which are pairs beside one another if the row is along x.
template <class T, class Row, class F>
[[gnu::always_inline]] inline void for_pairs(T* const* table, const Row& row, std::uint32_t begin,
                                             std::uint32_t count, F&& f) {
  T* const first = table[row.array] + row.first + std::ptrdiff_t(begin) * row.step;
  const std::ptrdiff_t step = row.step;
  if (step == 2)
    for (std::ptrdiff_t n = 0; n < count; ++n) f(n, first[2 * n], first[2 * n + 1]);
  else
    for (std::ptrdiff_t n = 0; n < count; ++n) f(n, first[n * step], first[n * step + 1]);
}

}  // namespace

template <class T>
void LevelBorder<T>::before_coarse_pass() {
  fetch(before_, arriving<const T>(std::as_const(coarse_), coarse_.parity()), coarse_before_);
}

template <class T>
void LevelBorder<T>::after_coarse_pass() {
  fetch(coarse_left_, left_and_returned(coarse_), coarse_fetched_);
}

template <class T>
void LevelBorder<T>::begin_fine_pass() {
  const Parity after = flipped(fine_.parity());
  now_.sub_step = int(fine_.passes() % 2);
  now_.fine_arriving = arriving<T>(fine_, after);
  now_.fine_left = left(fine_, after);
  now_.fine_left.push_back(fine_fetched_[now_.sub_step].data());
  now_.coarse_arriving = arriving<T>(coarse_, coarse_.parity());
  now_.coarse_left = left_and_returned(coarse_);
  now_.coarse_left.push_back(coarse_fetched_.data());
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
      for_row(now_.fine_left.data(), p.from, 0, p.length, [&](auto n, T v) { sums_[p.kept + n] = v; });
    else
      for_row(now_.fine_arriving.data(), p.to, 0, p.length,
              [&](auto n, T& to) { to = sums_[p.kept + n] + p.addend; });
}

template <class T>
void LevelBorder<T>::do_ready(const Ready& ready) {
  for (const Explosion& e : ready.explosions) explode(e);
  for (const Coalescence& c : ready.coalescences) coalesce(c);
}

/// A packet carries the population of its cell in its corner, and of what collision has just added to it a
/// fourth less or more: as much as it would have had a fourth of a step earlier or later.
template <class T>
void LevelBorder<T>::explode(const Explosion& e) {
  const T* const* const table = now_.coarse_left.data();
  T* const* const arrays = now_.fine_arriving.data();
  const T in_time = now_.sub_step == 0 ? T(0.25) : T(-0.25);
  in_parts(e.length, [&](std::uint32_t begin, std::uint32_t count) {
    T value[most], change[3][most];
    for (int d = 0; d < 3; ++d) {
      for_row(table, e.above[d], begin, count, [&](auto n, T v) { change[d][n] = v; });
      for_row(table, e.below[d], begin, count,
              [&](auto n, T v) { change[d][n] = e.slope[d] * (change[d][n] - v); });
    }
    for_row(table, e.value, begin, count, [&](auto n, T v) { value[n] = v; });
    if (const T* const before = coarse_before_.data() + e.before + begin; e.before >= 0)
      for (std::uint32_t n = 0; n < count; ++n) value[n] += in_time * (before[n] - value[n]);
    for (const auto& packet : e.packets) {
      if (packet.sub_step != now_.sub_step) continue;
      const auto sign = [&](int d) { return packet.corner >> d & 1 ? T(1) : T(-1); };
      const T x = sign(0), y = sign(1), z = sign(2), addend = packet.addend;
      const auto middle = [&](auto n) { return value[n] + (y * change[1][n] + z * change[2][n]) + addend; };
      if (packet.paired)
        for_pairs(arrays, packet.to, begin, count, [&](auto n, T& low, T& high) {
          const T between = middle(n);
          low = between - change[0][n], high = between + change[0][n];
        });
      else
        for_row(arrays, packet.to, begin, count, [&](auto n, T& to) { to = middle(n) + x * change[0][n]; });
    }
  });
}

template <class T>
void LevelBorder<T>::coalesce(const Coalescence& c) {
  const T* const* const table = now_.fine_left.data();
  T* const* const arrays = now_.coarse_arriving.data();
  in_parts(c.length, [&](std::uint32_t begin, std::uint32_t count) {
    T* const sum = sums_.data() + c.sum + begin;
    if (now_.sub_step == 0) std::fill_n(sum, count, T(0));
    for (const auto& packets : c.packets[now_.sub_step])
      if (packets.paired)
        for_pairs(table, packets.from, begin, count,
                  [&](auto n, T low, T high) { sum[n] = sum[n] + low + high; });
      else
        for_row(table, packets.from, begin, count, [&](auto n, T v) { sum[n] += v; });
    if (now_.sub_step == 0) return;
    if (const int from_coarse = 8 - c.count; from_coarse > 0)
      for_row(arrays, c.to, begin, count, [&](auto n, T v) { sum[n] += from_coarse * v; });
    for (const auto& taken : c.taken) {
      for_row(now_.coarse_left.data(), taken.above, begin, count,
              [&](auto n, T v) { sum[n] -= taken.factor * v; });
      for_row(now_.coarse_left.data(), taken.below, begin, count,
              [&](auto n, T v) { sum[n] += taken.factor * v; });
    }
    for_row(arrays, c.to, begin, count, [&](auto n, T& to) { to = sum[n] / 8 + c.addend; });
  });
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

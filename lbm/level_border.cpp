#include "lbm/level_border.hpp"

#include <algorithm>
#include <utility>

namespace silt::lbm {

namespace {

/// The arrays of all directions of the blocks: what arrives, or what left.
template <class T, class F>
std::vector<T*> arriving(F& fluid) {
  std::vector<T*> arrays;
  for (auto& block : fluid.blocks())
    for (int i = 0; i < directions; ++i) arrays.push_back(block.data() + block.arriving(i, fluid.parity()));
  return arrays;
}
template <class T>
std::vector<const T*> left(const Fluid<T>& fluid) {
  std::vector<const T*> arrays;
  for (const auto& block : fluid.blocks())
    for (int i = 0; i < directions; ++i) arrays.push_back(block.data() + block.leaving(i, fluid.parity()));
  return arrays;
}
template <class T>
std::vector<const T*> left_and_returned(const Fluid<T>& coarse) {
  std::vector<const T*> arrays = left(coarse);
  const auto returned = arriving<const T>(coarse);
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
  fetch(before_, arriving<const T>(std::as_const(coarse_)), coarse_before_);
}

template <class T>
void LevelBorder<T>::after_coarse_pass() {
  fetch(coarse_left_, left_and_returned(coarse_), coarse_fetched_);
}

template <class T>
void LevelBorder<T>::after_fine_pass() {
  const int sub_step = fine_.passes() % 2 == 0;
  fetch(fine_left_[sub_step], left(fine_), fine_fetched_[sub_step]);
  explode(sub_step);
  coalesce(sub_step);
}

/// A packet carries the population of its cell in its corner, and of what collision has just added to it a
/// fourth less or more: as much as it would have had a fourth of a step earlier or later.
template <class T>
void LevelBorder<T>::explode(int sub_step) {
  const auto arrays = arriving<T>(fine_);
  auto table = left_and_returned(coarse_);
  table.push_back(coarse_fetched_.data());
  const T in_time = sub_step == 0 ? T(0.25) : T(-0.25);
  for (const Explosion& e : explosions_)
    in_parts(e.length, [&](std::uint32_t begin, std::uint32_t count) {
      T value[most], change[3][most];
      for (int d = 0; d < 3; ++d) {
        for_row(table.data(), e.above[d], begin, count, [&](auto n, T v) { change[d][n] = v; });
        for_row(table.data(), e.below[d], begin, count,
                [&](auto n, T v) { change[d][n] = e.slope[d] * (change[d][n] - v); });
      }
      for_row(table.data(), e.value, begin, count, [&](auto n, T v) { value[n] = v; });
      if (const T* const before = coarse_before_.data() + e.before + begin; e.before >= 0)
        for (std::uint32_t n = 0; n < count; ++n) value[n] += in_time * (before[n] - value[n]);
      for (const auto& packet : e.packets) {
        if (packet.sub_step != sub_step) continue;
        const auto sign = [&](int d) { return packet.corner >> d & 1 ? T(1) : T(-1); };
        const T x = sign(0), y = sign(1), z = sign(2), addend = packet.addend;
        const auto middle = [&](auto n) { return value[n] + (y * change[1][n] + z * change[2][n]) + addend; };
        if (packet.paired)
          for_pairs(arrays.data(), packet.to, begin, count, [&](auto n, T& low, T& high) {
            const T between = middle(n);
            low = between - change[0][n], high = between + change[0][n];
          });
        else
          for_row(arrays.data(), packet.to, begin, count,
                  [&](auto n, T& to) { to = middle(n) + x * change[0][n]; });
      }
    });
  if (sub_step == 1)
    for (const Passing& p : passing_)
      for_row(arrays.data(), p.to, 0, p.length, [&](auto n, T& to) { to = sums_[p.kept + n] + p.addend; });
}

template <class T>
void LevelBorder<T>::coalesce(int sub_step) {
  const auto arrays = arriving<T>(coarse_);
  auto table = left(fine_);
  table.push_back(fine_fetched_[sub_step].data());
  auto coarse_table = left_and_returned(coarse_);
  coarse_table.push_back(coarse_fetched_.data());
  for (const Coalescence& c : coalescences_)
    in_parts(c.length, [&](std::uint32_t begin, std::uint32_t count) {
      T* const sum = sums_.data() + c.sum + begin;
      if (sub_step == 0) std::fill_n(sum, count, T(0));
      for (const auto& packets : c.packets[sub_step])
        if (packets.paired)
          for_pairs(table.data(), packets.from, begin, count,
                    [&](auto n, T low, T high) { sum[n] = sum[n] + low + high; });
        else
          for_row(table.data(), packets.from, begin, count, [&](auto n, T v) { sum[n] += v; });
      if (sub_step == 0) return;
      const int from_coarse = 8 - c.count;
      if (from_coarse > 0)
        for_row(arrays.data(), c.to, begin, count, [&](auto n, T v) { sum[n] += from_coarse * v; });
      for (const auto& taken : c.taken) {
        for_row(coarse_table.data(), taken.above, begin, count,
                [&](auto n, T v) { sum[n] -= taken.factor * v; });
        for_row(coarse_table.data(), taken.below, begin, count,
                [&](auto n, T v) { sum[n] += taken.factor * v; });
      }
      for_row(arrays.data(), c.to, begin, count, [&](auto n, T& to) { to = sum[n] / 8 + c.addend; });
    });
  if (sub_step == 0)
    for (const Passing& p : passing_)
      for_row(table.data(), p.from, 0, p.length, [&](auto n, T v) { sums_[p.kept + n] = v; });
}

template void LevelBorder<float>::before_coarse_pass();
template void LevelBorder<float>::after_coarse_pass();
template void LevelBorder<float>::after_fine_pass();
template void LevelBorder<double>::before_coarse_pass();
template void LevelBorder<double>::after_coarse_pass();
template void LevelBorder<double>::after_fine_pass();

}  // namespace silt::lbm

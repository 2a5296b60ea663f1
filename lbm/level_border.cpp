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
void fetch(SlotExchange<T>& slots, const std::vector<const T*>& from, std::vector<T>& to) {
  T* const target[] = {to.data()};
  slots.start(from);
  slots.finish(from, target);
}

}  // namespace

template <class T>
void LevelBorder<T>::before_coarse_pass() {
  fetch(before_, arriving<const T>(std::as_const(coarse_)), coarse_before_);
}

template <class T>
void LevelBorder<T>::after_coarse_pass() {
  std::vector<const T*> from = left(coarse_);  // and, for what an outlet returned, what arrives
  const auto returned = arriving<const T>(std::as_const(coarse_));
  from.insert(from.end(), returned.begin(), returned.end());
  fetch(coarse_left_, from, coarse_values_);
}

template <class T>
void LevelBorder<T>::after_fine_pass() {
  const int sub_step = fine_.passes() % 2 == 0;
  fetch(fine_left_[sub_step], left(fine_), fine_values_);
  explode(sub_step);
  if (sub_step == 1) coalesce();
}

/// A packet carries the population of its cell in its corner, and of what collision has just added to it a
/// fourth less or more: as much as it would have had a fourth of a step earlier or later.
template <class T>
void LevelBorder<T>::explode(int sub_step) {
  constexpr std::uint32_t most = 64;
  const auto arrays = arriving<T>(fine_);
  const T* const v = coarse_values_.data();
  const T in_time = sub_step == 0 ? T(0.25) : T(-0.25);
  for (const Explosion& e : explosions_)
    for (std::uint32_t begin = 0; begin < e.length; begin += most) {
      const std::uint32_t count = std::min(most, e.length - begin);
      T value[most], change[3][most];
      for (std::uint32_t n = 0; n < count; ++n) {
        value[n] = v[e.at.of(Explosion::value, begin + n)];
        for (int d = 0; d < 3; ++d)
          change[d][n] = e.slope[d] * (v[e.at.of(Explosion::plus + d, begin + n)] -
                                       v[e.at.of(Explosion::minus + d, begin + n)]);
        if (e.in_time)
          value[n] += in_time * (coarse_before_[e.at.of(Explosion::before, begin + n)] - value[n]);
      }
      for (int k = 0; k < int(e.packets.size()); ++k) {
        const Packet& packet = e.packets[k];
        if (packet.sub_step != sub_step) continue;
        const auto sign = [&](int d) { return packet.corner >> d & 1 ? T(1) : T(-1); };
        const T x = sign(0), y = sign(1), z = sign(2);
        T* const to = arrays[packet.array];
        for (std::uint32_t n = 0; n < count; ++n)
          to[e.at.of(Explosion::target + k, begin + n)] =
              value[n] + (x * change[0][n] + y * change[1][n] + z * change[2][n]) + packet.addend;
      }
    }
  if (sub_step == 1)
    for (const Passing& p : passing_) arrays[p.array][p.target] = fine_values_[p.value] + p.addend;
}

template <class T>
void LevelBorder<T>::coalesce() {
  const auto arrays = arriving<T>(coarse_);
  const T* const v = fine_values_.data();
  for (const Coalescence& c : coalescences_) {
    T* const to = arrays[c.array];
    for (std::uint32_t n = 0; n < c.length; ++n) {
      const auto packet = [&](int k) { return v[c.at.of(Coalescence::packet + k, n)]; };
      T& arriving = to[c.at.of(Coalescence::target, n)];
      if (c.packets == 8) {
        arriving = (((packet(0) + packet(1)) + (packet(2) + packet(3))) +
                    ((packet(4) + packet(5)) + (packet(6) + packet(7)))) /
                       8 +
                   c.addend;
        continue;
      }
      T sum = (8 - c.packets) * arriving;  // what came from coarse cells alone
      for (int k = 0; k < c.packets; ++k) sum += packet(k);
      for (const auto& t : c.taken) sum -= t.factor * (coarse_values_[t.plus] - coarse_values_[t.minus]);
      arriving = sum / 8 + c.addend;
    }
  }
}

template class LevelBorder<float>;
template class LevelBorder<double>;

}  // namespace silt::lbm

#pragma once
// Random points in a box, a Poisson process in space and time, as a function of a key. The box is cut into
// equal cells, time into rounds with one point per cell and round on average.
#include <algorithm>
#include <array>
#include <cstdint>

#include "coupler/spec/counter_random.hpp"
#include "rigid/math/types.hpp"

namespace silt {

class Rain {
 public:
  static constexpr std::uint64_t most_rounds = 1 << 23;
  static constexpr double most_cells = 0x1p36;
  using Cell = std::array<std::int64_t, 3>;

  /// Makes at least `cells` and at most twice as many nearly cubic cells.
  Rain(const rigid::BoundingBox& room, std::uint64_t key, double cells) : room_(room), key_(key) {
    for (double made = 1; made < cells; made *= 2) {
      int widest = 0;
      for (int d = 1; d < 3; ++d)
        if (side(d, 1) - side(d, 0) > side(widest, 1) - side(widest, 0)) widest = d;
      count_[widest] *= 2;
    }
  }

  const Cell& cells() const { return count_; }
  std::uint64_t total_cells() const { return count_[0] * count_[1] * count_[2]; }
  /// Returns the upper bound of numbers.
  std::uint64_t range() const { return total_cells() << draw_bits; }

  /// Calls f(number) for the points of a cell in a round.
  template <class F>
  void for_points(const Cell& cell, std::uint64_t round, F&& f) const {
    const std::uint64_t place = (cell[2] * count_[1] + cell[1]) * count_[0] + cell[0];
    const std::uint64_t first = (place << draw_bits) | (round << round_bits);
    const std::uint64_t random = time_of(first + most_in_round);
    const auto many = std::upper_bound(cumulated.begin(), cumulated.end(), random) - cumulated.begin();
    for (std::uint64_t k = 0; k < static_cast<std::uint64_t>(many); ++k) f(first + k);
  }
  /// Returns the time of a point, which orders those of a batch: uniform, all different.
  std::uint64_t time_of(std::uint64_t number) const { return coupler::mixed(number + key_); }
  rigid::Vec3 point(std::uint64_t number) const {
    const rigid::Vec3 share = coupler::CounterRandom(time_of(number)).point();
    std::uint64_t place = number >> draw_bits;
    rigid::Vec3 x;
    for (int d = 0; d < 3; ++d) {
      const auto n = static_cast<std::uint64_t>(count_[d]);
      const double cell = (static_cast<double>(place % n) + share[d]) / static_cast<double>(n);
      x[d] = std::min(room_.lower[d] + cell * (room_.upper[d] - room_.lower[d]), room_.upper[d]);
      place /= n;
    }
    return x;
  }
  rigid::Quat orientation(std::uint64_t number) const {
    coupler::CounterRandom random(time_of(number));
    random.point();
    return random.orientation();
  }
  /// Returns the lower face of cell `index` along an axis, which is the upper face of the one before.
  double side(int axis, std::int64_t index) const {
    const double share = static_cast<double>(index) / static_cast<double>(count_[axis]);
    return room_.lower[axis] + share * (room_.upper[axis] - room_.lower[axis]);
  }

 private:
  static constexpr int round_bits = 5, draw_bits = 28;
  static constexpr std::uint64_t most_in_round = (1 << round_bits) - 1;
  /// 2^64 times the probability of at most k points, for a mean of one.
  static constexpr auto cumulated = [] {
    std::array<std::uint64_t, 20> table{};
    long double term = 0.36787944117144232159552377016146087L, sum = term;  // 1/e
    for (std::size_t k = 0; k < table.size(); ++k) {
      table[k] = static_cast<std::uint64_t>(sum * 0x1p64L);
      term /= static_cast<long double>(k + 1);
      sum = std::min(sum + term, 1 - 0x1p-64L);
    }
    return table;
  }();

  rigid::BoundingBox room_;
  std::uint64_t key_;
  Cell count_{1, 1, 1};
};

}  // namespace silt

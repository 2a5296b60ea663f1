#include "coupler/placement/rain.hpp"

#include <algorithm>

namespace silt::coupler {
namespace {

/// 2^64 times the probability of at most k points, of one on average.
constexpr auto cumulated = [] {
  std::array<std::uint64_t, 20> table{};
  long double term = 0.36787944117144232159552377016146087L, sum = term;  // 1/e
  for (std::size_t k = 0; k < table.size(); ++k) {
    table[k] = static_cast<std::uint64_t>(sum * 0x1p64L);
    term /= static_cast<long double>(k + 1);
    sum = std::min(sum + term, 1 - 0x1p-64L);
  }
  return table;
}();

}  // namespace

Rain::Rain(const rigid::BoundingBox& room, std::uint64_t seed, std::uint64_t stream, double cells)
    : room_(room), stream_(mixed(seed) ^ mixed(~stream)) {
  for (double made = 1; made < cells; made *= 2) {
    int widest = 0;
    for (int d = 1; d < 3; ++d)
      if (side(d, 1) - side(d, 0) > side(widest, 1) - side(widest, 0)) widest = d;
    count_[widest] *= 2;
  }
}

std::uint64_t Rain::how_many(std::uint64_t random) {
  return std::upper_bound(cumulated.begin(), cumulated.end(), random) - cumulated.begin();
}

double Rain::side(int axis, std::int64_t index) const {
  const double share = static_cast<double>(index) / static_cast<double>(count_[axis]);
  return room_.lower[axis] + share * (room_.upper[axis] - room_.lower[axis]);
}

rigid::Vec3 Rain::point(std::uint64_t number) const {
  const rigid::Vec3 share = CounterRandom(time_of(number)).point();
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

rigid::Quat Rain::orientation(std::uint64_t number) const {
  CounterRandom random(time_of(number));
  random.point();
  return random.orientation();
}

}  // namespace silt::coupler

#pragma once
// Points that fall on a box, a Poisson process in space and time, as a function of a seed. The box is cut
// into equal cells, time into rounds: in a round one point a cell falls on average.
#include <array>
#include <cstdint>
#include <span>

#include "coupler/case/counter_random.hpp"
#include "rigid/shapes/bounding_box.hpp"

namespace silt::coupler {

class Rain {
 public:
  static constexpr std::uint64_t most_rounds = 1 << 23;
  static constexpr double most_cells = 0x1p36;
  using Cell = std::array<std::int64_t, 3>;

  /// stream: of the fill among those of one seed. Cells are near cubes; there are at least so many, at most
  /// twice.
  Rain(const rigid::BoundingBox& room, std::uint64_t seed, std::uint64_t stream, double cells);

  const Cell& cells() const { return count_; }
  std::uint64_t total_cells() const { return count_[0] * count_[1] * count_[2]; }
  /// Numbers are below this.
  std::uint64_t range() const { return total_cells() << draw_bits; }

  /// Calls f(number) for the points of a cell in a round.
  template <class F>
  void for_points(const Cell& cell, std::uint64_t round, F&& f) const {
    const std::uint64_t place = (cell[2] * count_[1] + cell[1]) * count_[0] + cell[0];
    const std::uint64_t first = (place << draw_bits) | (round << round_bits);
    const std::uint64_t many = how_many(time_of(first + most_in_round));
    for (std::uint64_t k = 0; k < many; ++k) f(first + k);
  }
  /// Places the points of some rounds in an order: uniform, no two alike.
  std::uint64_t time_of(std::uint64_t number) const { return mixed(number + stream_); }
  rigid::Vec3 point(std::uint64_t number) const;
  rigid::Quat orientation(std::uint64_t number) const;
  /// The side of a cell at an axis: lower, and upper by the next.
  double side(int axis, std::int64_t index) const;

 private:
  static constexpr int round_bits = 5, draw_bits = 28;
  static constexpr std::uint64_t most_in_round = (1 << round_bits) - 1;
  static std::uint64_t how_many(std::uint64_t random);

  rigid::BoundingBox room_;
  std::uint64_t stream_;
  Cell count_{1, 1, 1};
};

}  // namespace silt::coupler

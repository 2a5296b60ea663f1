#pragma once
// Cells, boxes of cells, and lattices: the vectors c_i along which populations move in a step, and their
// weights w_i. Direction 0 is at rest; 2k+1 and 2k+2 are opposite and form a pair. Blocks, ghost layers,
// borders of levels and cut links take the lattice as a template parameter.
#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "cpu/device_code.hpp"

namespace silt::lbm {

struct Int3 {
  int x = 0, y = 0, z = 0;
  constexpr int operator[](int d) const { return d == 0 ? x : d == 1 ? y : z; }
  constexpr int& operator[](int d) { return d == 0 ? x : d == 1 ? y : z; }
  friend constexpr Int3 operator+(Int3 a, Int3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Int3 operator-(Int3 a, Int3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  constexpr bool operator==(const Int3&) const = default;
};

struct CellBox {  // cells lower <= x < lower + size
  Int3 lower, size;
  bool contains(Int3 x) const {
    for (int d = 0; d < 3; ++d)
      if (x[d] < lower[d] || x[d] >= lower[d] + size[d]) return false;
    return true;
  }
  std::int64_t cells() const { return std::int64_t{size.x} * size.y * size.z; }
  bool operator==(const CellBox&) const = default;
};

inline CellBox grown(CellBox box, int by) {
  return {box.lower - Int3{by, by, by}, box.size + Int3{2 * by, 2 * by, 2 * by}};
}

/// Returns the cells in both boxes.
inline CellBox overlap(const CellBox& a, const CellBox& b) {
  CellBox both;
  for (int d = 0; d < 3; ++d) {
    both.lower[d] = std::max(a.lower[d], b.lower[d]);
    both.size[d] = std::max(0, std::min(a.lower[d] + a.size[d], b.lower[d] + b.size[d]) - both.lower[d]);
  }
  return both;
}

/// Calls visit(cell) for every cell with low <= cell < high, x fastest.
template <class Visit>
void for_cells(Int3 low, Int3 high, Visit&& visit) {
  for (int z = low.z; z < high.z; ++z)
    for (int y = low.y; y < high.y; ++y)
      for (int x = low.x; x < high.x; ++x) visit(Int3{x, y, z});
}

/// Returns the direction opposite to i.
inline constexpr int opposite(int i) {
  return i == 0 ? 0 : ((i - 1) ^ 1) + 1;
}
inline constexpr int norm2(Int3 v) {
  return v.x * v.x + v.y * v.y + v.z * v.z;
}

/// The lattice of the fluid.
struct D3Q19 {
  static constexpr int directions = 19, pairs = 9;
  static constexpr std::array<Int3, directions> c = {{{0, 0, 0},
                                                      {1, 0, 0},
                                                      {-1, 0, 0},
                                                      {0, 1, 0},
                                                      {0, -1, 0},
                                                      {0, 0, 1},
                                                      {0, 0, -1},
                                                      {1, 1, 0},
                                                      {-1, -1, 0},
                                                      {1, -1, 0},
                                                      {-1, 1, 0},
                                                      {1, 0, 1},
                                                      {-1, 0, -1},
                                                      {1, 0, -1},
                                                      {-1, 0, 1},
                                                      {0, 1, 1},
                                                      {0, -1, -1},
                                                      {0, 1, -1},
                                                      {0, -1, 1}}};
  static constexpr double w(int i) { return i == 0 ? 1.0 / 3 : norm2(c[i]) == 1 ? 1.0 / 18 : 1.0 / 36; }
  static constexpr double sound_speed_squared = 1.0 / 3;
};

/// The lattice of the temperature. Its directions are the first seven of D3Q19.
struct D3Q7 {
  static constexpr int directions = 7, pairs = 3;
  static constexpr std::array<Int3, directions> c = {
      {{0, 0, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
  static constexpr double w(int i) { return i == 0 ? 1.0 / 4 : 1.0 / 8; }
  static constexpr double sound_speed_squared = 1.0 / 4;
};

/// Returns the direction with this vector, or -1.
template <class Lattice>
constexpr int direction_of(Int3 v) {
  for (int i = 0; i < Lattice::directions; ++i)
    if (Lattice::c[i] == v) return i;
  return -1;
}

/// Calls f(std::integral_constant) for each direction from `first` on. Device code cannot index the tables of
/// directions at run time, only at compile time.
template <class Lattice, int first, class F>
SILT_DEVICE [[gnu::always_inline]] inline void for_directions(F&& f) {
  [&]<int... k>(std::integer_sequence<int, k...>) __attribute__((always_inline)) {
    (f(std::integral_constant<int, first + k>()), ...);
  }
  (std::make_integer_sequence<int, Lattice::directions - first>());
}

/// Returns whether a lattice meets sum w = 1, sum w c = 0, sum w c c = c_s^2 I, and opposites are neighbours.
template <class Lattice>
constexpr bool is_isotropic() {
  const auto is = [](double a, double b) { return a - b < 1e-15 && b - a < 1e-15; };
  double mass = 0, momentum[3] = {}, flux[3][3] = {};
  for (int i = 0; i < Lattice::directions; ++i) {
    const double w = Lattice::w(i);
    const Int3 c = Lattice::c[i];
    if (!(c + Lattice::c[opposite(i)] == Int3{}) || w != Lattice::w(opposite(i))) return false;
    mass += w;
    for (int d = 0; d < 3; ++d) momentum[d] += w * c[d];
    for (int d = 0; d < 9; ++d) flux[d / 3][d % 3] += w * c[d / 3] * c[d % 3];
  }
  bool all = is(mass, 1);
  for (int d = 0; d < 3; ++d) all &= is(momentum[d], 0);
  for (int d = 0; d < 9; ++d)
    all &= is(flux[d / 3][d % 3], d / 3 == d % 3 ? Lattice::sound_speed_squared : 0);
  return all;
}
static_assert(is_isotropic<D3Q19>() && is_isotropic<D3Q7>());

}  // namespace silt::lbm

#pragma once
// Cells and boxes of them, and the directions of D3Q19. Direction 0 rests; 2k+1 and 2k+2 are opposite: a
// pair. Weights w, sound speed c_s^2 = 1/3.
#include <algorithm>
#include <array>
#include <cstddef>
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
};

inline CellBox grown(CellBox box, int by) {
  return {box.lower - Int3{by, by, by}, box.size + Int3{2 * by, 2 * by, 2 * by}};
}

/// Returns the cells that both have.
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

inline constexpr int directions = 19, pairs = 9;
inline constexpr std::array<Int3, directions> c = {{{0, 0, 0},
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
inline constexpr int opposite(int i) {
  return i == 0 ? 0 : ((i - 1) ^ 1) + 1;
}
inline constexpr int norm2(int i) {
  return c[i].x * c[i].x + c[i].y * c[i].y + c[i].z * c[i].z;
}
inline constexpr double w(int i) {
  return i == 0 ? 1.0 / 3 : norm2(i) == 1 ? 1.0 / 18 : 1.0 / 36;
}

inline constexpr int direction_of(Int3 v) {
  for (int i = 0; i < directions; ++i)
    if (c[i] == v) return i;
  return -1;
}

/// Calls f with the directions from `first` on, as constants of the type: the tables of directions exist only
/// for the compiler where code is for a graphics processor.
template <int first, class F>
SILT_DEVICE [[gnu::always_inline]] inline void for_directions(F&& f) {
  [&]<int... k>(std::integer_sequence<int, k...>) __attribute__((always_inline)) {
    (f(std::integral_constant<int, first + k>()), ...);
  }
  (std::make_integer_sequence<int, directions - first>());
}

namespace check {  // sum w = 1, sum w c c = 1/3 (in 36ths), opposites cancel
constexpr bool moments() {
  int mass = 0, xx = 0, xy = 0, x = 0;
  for (int i = 0; i < directions; ++i) {
    const int w36 = i == 0 ? 12 : norm2(i) == 1 ? 2 : 1;
    mass += w36, x += w36 * c[i].x, xx += w36 * c[i].x * c[i].x, xy += w36 * c[i].x * c[i].y;
    if (!(c[i] + c[opposite(i)] == Int3{})) return false;
  }
  return mass == 36 && xx == 12 && xy == 0 && x == 0;
}
static_assert(moments());
}  // namespace check

}  // namespace silt::lbm

// Built once an instruction set.
#include <algorithm>
#include <bit>
#include <span>
#include <utility>

#include "coupler/mapping/mesh_lines.hpp"
#include "lbm/cut_links.hpp"
#include "lbm/isa_vector.hpp"

namespace silt::coupler::SILT_ISA {

namespace {

using lbm::Int3;

void place_corners(const double* from, std::size_t count, const double* turn, const double* position,
                   const std::int64_t* base, Whole3* corner, float* rough) {
  for (std::size_t k = 0; k < count; ++k)
    for (int d = 0; d < 3; ++d) {
      const double* const x = from + 3 * k;
      const double y =
          position[d] + (turn[3 * d] * x[0] + turn[3 * d + 1] * x[1] + turn[3 * d + 2] * x[2]) - 0.5;
      corner[k][d] = to_whole(y * double(cell_units));
      rough[3 * k + d] = float(y - double(base[d]));
    }
}

using Floats = lbm::SILT_ISA::VectorOf<float>::type;
using Ints = lbm::SILT_ISA::VectorOf<int>::type;
constexpr int lanes = int(sizeof(Floats) / sizeof(float));

Floats least(Floats a, Floats b) {
  return a < b ? a : b;
}
Floats largest(Floats a, Floats b) {
  return a > b ? a : b;
}

/// One of a half of the directions, known where code is made.
template <int number_>
struct Direction {
  static constexpr int number = number_;
  static constexpr Lines lines = Lines(2 * number + 1);
};
constexpr int half_directions = (lbm::directions - 1) / 2;

/// Calls use(Direction<number>()) for the first of the half.
template <int directions, class Use>
[[gnu::always_inline]] inline void for_directions(Use&& use) {
  [&]<int... number>(std::integer_sequence<int, number...>) {
    (use(Direction<number>()), ...);
  }
  (std::make_integer_sequence<int, directions>());
}

/// What triangles side by side span of a sum or difference of coordinates: how many lattice points, their
/// corners from the last of these, and the largest distance.
struct Span {
  Ints points;
  Floats from[3], furthest;

  /// at: of the corners, in cells.
  [[gnu::always_inline]] void set(Floats a, Floats b, Floats c) {
    constexpr float margin = 4e-3f, above = 16384;  // cells: of rounding
    const Floats low = least(least(a, b), c), high = largest(largest(a, b), c);
    const Ints last = __builtin_convertvector(high + (above + margin), Ints);
    points = last - __builtin_convertvector(low + (above - margin), Ints);
    const Floats last_point = __builtin_convertvector(last, Floats) - above;
    from[0] = a - last_point, from[1] = b - last_point, from[2] = c - last_point;
    furthest = largest(high - last_point, last_point - low);
  }
};

/// Triangles side by side, to rounding: what they span of x, y, z and of the sums and differences of two.
class RoughTriangles {
 public:
  /// Takes `lanes` triangles of those wanted; after the last the last again. `above`: whole cells that make
  /// all that matters positive.
  [[gnu::always_inline]] RoughTriangles(const TriangleView& view, std::size_t first, const float* above) {
    Floats x[3][3];
    for (int l = 0; l < lanes; ++l) {
      const auto& t = view.triangles[view.wanted[std::min(first + std::size_t(l), view.count - 1)]];
      for (int k = 0; k < 3; ++k)
        for (int d = 0; d < 3; ++d) x[d][k][l] = view.rough[3 * std::size_t(t[k]) + d] + above[d];
    }
    for (int d = 0; d < 3; ++d) spans_[d].set(x[d][0], x[d][1], x[d][2]);
    for (int e = 1; e < 3; ++e)
      for (int d = 0; d < e; ++d) {
        spans_[of_two(d, e, 1)].set(x[e][0] - x[d][0], x[e][1] - x[d][1], x[e][2] - x[d][2]);
        spans_[of_two(d, e, -1)].set(x[e][0] + x[d][0], x[e][1] + x[d][1], x[e][2] + x[d][2]);
      }
  }

  /// Finds those that may meet one of the lines: not 0.
  [[gnu::always_inline]] Ints near(const Lines& lines) const {
    const Span &u = across(lines.a, lines.c_a, lines.axis), &v = across(lines.b, lines.c_b, lines.axis);
    // on which side of the edges the line passes, if there is but one
    const Floats side0 = u.from[1] * v.from[2] - u.from[2] * v.from[1],
                 side1 = u.from[2] * v.from[0] - u.from[0] * v.from[2],
                 side2 = u.from[0] * v.from[1] - u.from[1] * v.from[0];
    const Floats rounding = 4e-3f * (u.furthest + v.furthest);
    const Ints beside =
        (least(least(side0, side1), side2) < -rounding) & (largest(largest(side0, side1), side2) > rounding);
    const Ints one = (u.points == 1) & (v.points == 1);
    return (u.points > 0) & (v.points > 0) & ~(one & beside);
  }

 private:
  /// Of x_other - slope x_axis.
  [[gnu::always_inline]] const Span& across(int other, int slope, int axis) const {
    return spans_[slope == 0 ? other : of_two(std::min(other, axis), std::max(other, axis), slope)];
  }
  /// Of x_e - slope x_d, d below e.
  static constexpr int of_two(int d, int e, int slope) { return 2 + d + e + (slope < 0 ? 3 : 0); }

  Span spans_[9];
};

/// The lines along a direction that pass cells of a box.
struct LinesInBox {
  Range us, vs;

  LinesInBox(const Lines& lines, Int3 low, Int3 high) {
    const auto range = [&](int d, int slope) {
      const int first = slope * low[lines.axis], last = slope * high[lines.axis];
      return Range{low[d] - std::max(first, last), high[d] - std::min(first, last)};
    };
    us = range(lines.a, lines.c_a), vs = range(lines.b, lines.c_b);
  }
};

/// Some triangles that follow each other: by direction those that may meet lines along it.
template <int directions>
class NearTriangles {
 public:
  static constexpr std::size_t most = 512;  // stay in the nearest cache

  void find(const TriangleView& view, std::size_t first, const float* above) {
    std::fill_n(count_, directions, 0);
    const std::size_t end = std::min(first + most, view.count);
    for (std::size_t n = first; n < end; n += lanes) {
      const RoughTriangles rough(view, n, above);
      for_directions<directions>([&](auto direction) {
        for (unsigned near = lbm::SILT_ISA::lane_bits(rough.near(direction.lines)); near != 0;
             near &= near - 1)
          list_[direction.number][count_[direction.number]++] =
              std::uint32_t(n) + unsigned(std::countr_zero(near));
      });
    }
    for (int k = 0; k < directions; ++k)
      while (count_[k] > 0 && list_[k][count_[k] - 1] >= end) --count_[k];
  }
  /// Numbers of `wanted`.
  std::span<const std::uint32_t> of(int direction) const { return {list_[direction], count_[direction]}; }

 private:
  std::uint32_t list_[directions][most + lanes], count_[directions];
};

/// Calls visit(direction, u, v, w) for all crossings of the triangles with lines that pass cells of a box,
/// along the first `directions` of the half.
template <Touching touching, int directions, class Visit>
void for_crossings(const TriangleView& view, Int3 low, Int3 high, const Visit& visit) {
  float above[3];
  for (int d = 0; d < 3; ++d) above[d] = float(view.base[d] - low[d]);
  NearTriangles<directions> near;
  for (std::size_t first = 0; first < view.count; first += near.most) {
    near.find(view, first, above);
    for_directions<directions>([&](auto direction) {
      const LinesInBox box(direction.lines, low, high);
      for (const std::uint32_t n : near.of(direction.number)) {
        const auto& t = view.triangles[view.wanted[n]];
        const SeenTriangle seen(view.corner[t[0]], view.corner[t[1]], view.corner[t[2]], direction.lines);
        const Range u = box.us.within(seen.u_range()), v = box.vs.within(seen.v_range());
        if (u.empty() || v.empty()) continue;
        seen.template meet<touching>(u, v, [&](std::int64_t at_u, std::int64_t at_v, std::int64_t w) {
          visit(direction, at_u, at_v, w);
        });
      }
    });
  }
}

void mark_changes(const TriangleView& view, const BitFrame& frame, Int3 low, std::uint64_t* words) {
  const Int3 first = low + Int3{2, 2, 2}, last = low + frame.size - Int3{3, 3, 3};
  for_crossings<Touching::is_moved, 1>(
      view, first, last, [&](auto, std::int64_t y, std::int64_t z, std::int64_t w) {
        const std::int64_t x = std::max<std::int64_t>((w + cell_units - 1) >> cell_bits, first.x);
        if (x > last.x) return;
        const std::size_t bit = std::size_t(z - low.z) * std::size_t(frame.plane) * 64 +
                                std::size_t(y - low.y) * std::size_t(frame.pitch) + std::size_t(x - low.x);
        words[bit >> 6] ^= std::uint64_t{1} << (bit & 63);
      });
}

std::size_t bit_of(const BitFrame& frame, Int3 x) {
  return std::size_t(x.z) * std::size_t(frame.plane) * 64 + std::size_t(x.y) * std::size_t(frame.pitch) +
         std::size_t(x.x);
}
bool test(const std::uint64_t* words, std::size_t bit) {
  return words[bit >> 6] >> (bit & 63) & 1;
}
/// Of a cell of `near`.
std::uint32_t& least_of(const LinkDistances& links, std::size_t bit, int direction) {
  const std::uint64_t lower = links.near[bit >> 6] & ((std::uint64_t{1} << (bit & 63)) - 1);
  return links.least[(links.before[bit >> 6] + std::size_t(std::popcount(lower))) * lbm::directions +
                     std::size_t(direction)];
}

bool within(const BitFrame& frame, Int3 x) {
  return unsigned(x.x) < unsigned(frame.size.x) && unsigned(x.y) < unsigned(frame.size.y) &&
         unsigned(x.z) < unsigned(frame.size.z);
}

void cut_links(const TriangleView& view, Int3 low, const LinkDistances& links) {
  constexpr std::int64_t rounding = 4;  // units: a crossing so near a lattice point is at it
  const auto note = [&](std::size_t from, std::size_t to, int direction, std::int64_t distance) {
    if (!test(links.near, from) || !test(links.body, to)) return;
    std::uint32_t& least = least_of(links, from, direction);
    least = std::min(least, std::uint32_t(distance));
  };
  const Int3 high = low + links.frame.size - Int3{1, 1, 1};
  for_crossings<Touching::counts, half_directions>(
      view, low, high, [&](auto direction, std::int64_t u, std::int64_t v, std::int64_t w) {
        constexpr Lines lines = direction.lines;
        for (std::int64_t k = (w - rounding) >> cell_bits; k <= (w + rounding) >> cell_bits; ++k) {
          const Int3 from = lines.cell(u, v, k) - low, to = lines.cell(u, v, k + 1) - low;
          if (!within(links.frame, from) || !within(links.frame, to)) continue;
          const std::size_t bit_from = bit_of(links.frame, from), bit_to = bit_of(links.frame, to);
          const std::int64_t distance = std::clamp<std::int64_t>(w - k * cell_units, 0, cell_units);
          note(bit_from, bit_to, lines.forward, distance);
          note(bit_to, bit_from, lines.backward, cell_units - distance);
        }
      });
}

void look_up(const LinkDistances& links, Int3 corner, const std::uint32_t* place, std::size_t count,
             std::uint32_t* distance) {
  for (std::size_t k = 0; k < count; ++k) {
    const Int3 x = corner + lbm::place_cell(place[k]) - links.frame.low;
    distance[k] = least_of(links, bit_of(links.frame, x), lbm::place_direction(place[k]));
  }
}

}  // namespace

MeshKernels mesh_kernels() {
  return {place_corners, mark_changes, cut_links, look_up};
}

}  // namespace silt::coupler::SILT_ISA

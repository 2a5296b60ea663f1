// The kernels of meshes, built once per instruction set. Planes of lattice points cut triangles into
// segments, whose ends are rounded to whole units and are equal for both triangles at an edge: the segments
// of a closed surface form closed polygons, which meet every line of lattice points an even number of times.
// Doubles hold all numbers exactly, so results do not depend on blocks, ranks or instruction sets.
#include "coupler/mapping/mesh_kernel.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

#include "cpu/lanes.hpp"
#include "lbm/blocks/lattice.hpp"
#include "lbm/walls/cut_links.hpp"

namespace silt::coupler::SILT_BUILD {

using Doubles = VectorOf<double>::type;
using Longs = VectorOf<std::int64_t>::type;
inline constexpr int double_lanes = int(sizeof(Doubles) / sizeof(double));
inline constexpr double one_cell = double(cell_units);  // in units
inline constexpr double rounder = 0x1.8p52;             // adding it rounds to a whole number

/// Rounds numbers to whole numbers below 2^51.
template <class Number>
Number rounded(Number x) {
  return (x + rounder) - rounder;
}
/// Returns the last lattice point before x, a whole number of units.
inline Doubles lattice_point_before(Doubles x) {
  constexpr std::int64_t fraction = cell_units - 1;
  return std::bit_cast<Doubles>(std::bit_cast<Longs>(x - 1 + rounder) & ~fraction) - rounder;
}
inline std::int64_t cell_of(double lattice_point) {
  return std::int64_t(lattice_point) >> cell_bits;
}

/// The lines along direction c of one half of the directions, a compile-time constant. Along a line, the
/// coordinate `across` is `slope` (-1, 0, 1) times that of `along` plus a whole number.
template <int number_>
struct Direction {
  static constexpr int number = number_, forward = 2 * number + 1, backward = forward + 1;
  static constexpr int plane = number == 0 ? 2 : number < 3 ? number - 1 : 2 - (number - 3) / 2;
  static constexpr lbm::Int3 c = lbm::D3Q19::c[forward];
  static constexpr int along = c[0] != 0   ? 0
                               : c[1] != 0 ? 1
                                           : 2,
                       across = 3 - plane - along, slope = c[across];
  static_assert(c[along] == 1 && c[plane] == 0 && lbm::D3Q19::c[backward][along] == -1);
};

/// Calls use(Direction<number>()) for the directions whose lines are searched in planes across an axis: one
/// along an axis, two diagonals.
template <int axis, class Use>
[[gnu::always_inline]] inline void for_directions_in_plane(Use&& use) {
  constexpr int number = (axis + 1) % 3, diagonal = 3 + 2 * (2 - axis);
  static_assert(Direction<number>::plane == axis && Direction<diagonal>::plane == axis &&
                Direction<diagonal + 1>::plane == axis);
  use(Direction<number>()), use(Direction<diagonal>()), use(Direction<diagonal + 1>());
}

/// Segments in lanes, each in one plane: both ends, in units.
struct Segments {
  Doubles end[2][3];
  unsigned used;  // mask of lanes
};

/// Triangles in lanes, cut by planes across an axis.
template <int axis>
class SlicedTriangles {
 public:
  [[gnu::always_inline]] SlicedTriangles(const TriangleView& view, std::span<const std::uint32_t> list)
      : lanes_((1u << std::min<std::size_t>(list.size(), double_lanes)) - 1) {
    for (std::size_t l = 0; l < double_lanes; ++l) {
      const auto& t = view.triangles[list[std::min(l, list.size() - 1)]];
      for (int k = 0; k < 3; ++k)
        for (int d = 0; d < 3; ++d) x_[d][k][l] = view.corner[t[k]].at[d];
    }
  }
  /// Calls use(segments) for the planes from first to last, in units.
  template <class Use>
  [[gnu::always_inline]] void slice(double first, double last, Use&& use) const {
    const Doubles(&z)[3] = x_[axis];
    Doubles plane =
        largest(lattice_point_before(least(least(z[0], z[1]), z[2])) + one_cell, Doubles{} + first);
    const Doubles end = least(lattice_point_before(largest(largest(z[0], z[1]), z[2])), Doubles{} + last);
    for (unsigned used; (used = lanes_ & lane_bits(plane <= end)) != 0; plane += one_cell)
      use(cut(plane, used));
  }

 private:
  static Doubles least(Doubles a, Doubles b) { return a < b ? a : b; }
  static Doubles largest(Doubles a, Doubles b) { return a > b ? a : b; }

  /// Cuts the edges at the corner that is alone on its side of the plane; corners on it count as below.
  [[gnu::always_inline]] Segments cut(Doubles plane, unsigned used) const {
    const Doubles(&z)[3] = x_[axis];
    const Longs above[] = {z[0] > plane, z[1] > plane, z[2] > plane};
    const Longs first = above[1] == above[2], second = ~first & (above[0] == above[2]);
    const Longs is_above = first ? above[0] : second ? above[1] : above[2];
    Doubles alone[3], other[2][3];
    for (int d = 0; d < 3; ++d) {
      const Doubles(&x)[3] = x_[d];
      alone[d] = first ? x[0] : second ? x[1] : x[2];
      other[0][d] = first ? x[1] : second ? x[2] : x[0];
      other[1][d] = first ? x[2] : second ? x[0] : x[1];
    }
    Segments s;
    s.used = used;
    for (int k = 0; k < 2; ++k) {
      const Doubles low = is_above ? other[k][axis] : alone[axis],
                    high = is_above ? alone[axis] : other[k][axis];
      const Doubles part = (plane - low) / (high - low);
      for (int d = 0; d < 3; ++d) {
        const Doubles from = is_above ? other[k][d] : alone[d], to = is_above ? alone[d] : other[k][d];
        s.end[k][d] = d == axis ? plane : from + rounded(part * (to - from));
      }
    }
    return s;
  }

  unsigned lanes_;
  Doubles x_[3][3];  // coordinates, each of three corners
};

/// Calls visit(direction, x, w) for the lines along a direction that the segments meet between cells first
/// and last: x is the line's cell with coordinate 0 along it, w the position along it in units.
template <class Along, class Visit>
[[gnu::always_inline]] inline void meet_lines(const Segments& segments, Along direction, lbm::Int3 first,
                                              lbm::Int3 last, const Visit& visit) {
  constexpr int along = direction.along, across = direction.across, slope = direction.slope;
  const auto on = [&](int k) { return segments.end[k][across] - double(slope) * segments.end[k][along]; };
  const Doubles s0 = on(0), s1 = on(1), line0 = lattice_point_before(s0), line1 = lattice_point_before(s1);
  const int down = std::max(slope * first[along], slope * last[along]),
            up = std::min(slope * first[along], slope * last[along]);
  const double first_line = one_cell * (first[across] - down), last_line = one_cell * (last[across] - up);
  for (unsigned left = segments.used & lane_bits(line0 != line1); left != 0; left &= left - 1) {
    const int l = std::countr_zero(left);
    const double low = std::max(std::min(line0[l], line1[l]) + one_cell, first_line);
    const double high = std::min(std::max(line0[l], line1[l]), last_line);
    const double from = segments.end[0][along][l], to = segments.end[1][along][l];
    for (double line = low; line <= high; line += one_cell) {
      const double w = from + rounded((line - s0[l]) / (s1[l] - s0[l]) * (to - from));
      lbm::Int3 x;
      x[direction.plane] = int(cell_of(segments.end[0][direction.plane][l])), x[across] = int(cell_of(line));
      visit(direction, x, std::int64_t(w));
    }
  }
}

namespace {

using lbm::Int3;

void place_corners(const double* from, std::size_t count, const double* turn, const double* position,
                   Corner* corner) {
  using Four = VectorOf<double, 4>::type;
  using WholeFour = VectorOf<std::uint64_t, 4>::type;
  const Four columns[] = {
      {turn[0], turn[3], turn[6]}, {turn[1], turn[4], turn[7]}, {turn[2], turn[5], turn[8]}};
  const Four at{position[0], position[1], position[2]};
  for (std::size_t k = 0; k < count; ++k) {
    const double* const x = from + 3 * k;
    const Four y = at + (columns[0] * x[0] + columns[1] * x[1] + columns[2] * x[2]) - 0.5;
    const Four sum = y * one_cell + rounder,
               whole = sum - rounder;  // low bits of the sum: those of the number
    std::memcpy(&corner[k], &whole, sizeof whole);
    WholeFour bits;
    std::memcpy(&bits, &sum, sizeof bits);
    const WholeFour is_whole = ((bits << (64 - cell_bits)) == 0) & Corner::x_is_whole;
    const WholeFour field = ((bits >> cell_bits) & (Corner::x_is_whole - 1)) | is_whole;
    corner[k].between = field[0] | field[1] << Corner::field | field[2] << 2 * Corner::field;
  }
}

std::size_t bit_of(const BitFrame& frame, Int3 x) {
  return std::size_t(x.z) * std::size_t(frame.plane) * 64 + std::size_t(x.y) * std::size_t(frame.pitch) +
         std::size_t(x.x);
}

void mark_changes(const TriangleView& view, const BitFrame& frame, Int3 low, std::uint64_t* words) {
  constexpr Direction<0> along_x;
  const Int3 first = low + Int3{2, 2, 2}, last = low + frame.size - Int3{3, 3, 3};
  const auto change = [&](auto, Int3 line, std::int64_t w) {
    const int x = int(std::max<std::int64_t>((w + cell_units - 1) >> cell_bits, first.x));
    if (x > last.x) return;
    const std::size_t bit = bit_of(frame, Int3{x, line.y, line.z} - low);
    words[bit >> 6] ^= std::uint64_t{1} << (bit & 63);
  };
  for (const TrianglesByPlanes& part : view.parts)
    for (std::size_t n = 0; n < part.on_x_axis.size(); n += double_lanes)
      SlicedTriangles<along_x.plane>(view, part.on_x_axis.subspan(n))
          .slice(one_cell * first.z, one_cell * last.z,
                 [&](const Segments& segments) { meet_lines(segments, along_x, first, last, change); });
}

bool test(const std::uint64_t* words, std::size_t bit) {
  return words[bit >> 6] >> (bit & 63) & 1;
}
/// Returns the least distance found so far for a cell of `near`.
std::uint32_t& least_of(const LinkDistances& links, std::size_t bit, int direction) {
  const std::uint64_t lower = links.near[bit >> 6] & ((std::uint64_t{1} << (bit & 63)) - 1);
  return links.least[(links.before[bit >> 6] + std::size_t(std::popcount(lower))) * lbm::D3Q19::directions +
                     std::size_t(direction)];
}

bool within(const BitFrame& frame, Int3 x) {
  return unsigned(x.x) < unsigned(frame.size.x) && unsigned(x.y) < unsigned(frame.size.y) &&
         unsigned(x.z) < unsigned(frame.size.z);
}

void cut_links(const TriangleView& view, Int3 low, const LinkDistances& links) {
  constexpr std::int64_t rounding = 4;  // units: closer crossings are at the lattice point
  const Int3 last = low + links.frame.size - Int3{1, 1, 1};
  const auto cut = [&](auto direction, Int3 line, std::int64_t w) {
    for (std::int64_t k = (w - rounding) >> cell_bits; k <= (w + rounding) >> cell_bits; ++k) {
      Int3 from = line - low;
      from[direction.along] += int(k), from[direction.across] += direction.slope * int(k);
      const Int3 to = from + direction.c;
      if (!within(links.frame, from) || !within(links.frame, to)) continue;
      const std::size_t bit_from = bit_of(links.frame, from), bit_to = bit_of(links.frame, to);
      const bool from_body = test(links.body, bit_from);
      if (from_body == test(links.body, bit_to)) continue;
      const std::size_t fluid = from_body ? bit_to : bit_from;
      if (!test(links.near, fluid)) continue;
      const std::int64_t along = std::clamp<std::int64_t>(w - k * cell_units, 0, cell_units);
      std::uint32_t& least = least_of(links, fluid, from_body ? direction.backward : direction.forward);
      least = std::min(least, std::uint32_t(from_body ? cell_units - along : along));
    }
  };
  const auto in_planes = [&]<int axis>(std::integral_constant<int, axis>,
                                       std::span<const std::uint32_t> list) {
    for (std::size_t n = 0; n < list.size(); n += double_lanes)
      SlicedTriangles<axis>(view, list.subspan(n))
          .slice(one_cell * low[axis], one_cell * last[axis], [&](const Segments& segments) {
            for_directions_in_plane<axis>(
                [&](auto direction) { meet_lines(segments, direction, low, last, cut); });
          });
  };
  for (const TrianglesByPlanes& part : view.parts) {
    in_planes(std::integral_constant<int, 0>(), part.in_plane[0]);
    in_planes(std::integral_constant<int, 1>(), part.in_plane[1]);
    in_planes(std::integral_constant<int, 2>(), part.in_plane[2]);
  }
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

}  // namespace silt::coupler::SILT_BUILD

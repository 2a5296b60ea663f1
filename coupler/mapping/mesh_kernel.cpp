// Built once an instruction set.
#include <algorithm>
#include <bit>

#include "coupler/mapping/mesh_kernels.hpp"
#include "lbm/cut_links.hpp"

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

constexpr int lanes = 16;

/// Corners of triangles side by side, in cells.
struct RoughTriangles {
  float x[3][3][lanes];  // corner, coordinate

  /// `above`: whole cells that make all that matters positive.
  RoughTriangles(const TriangleView& view, std::size_t first, int n, const float* above) {
    for (int l = 0; l < lanes; ++l) {
      const auto& t = view.triangles[view.wanted[first + std::size_t(std::min(l, n - 1))]];
      for (int k = 0; k < 3; ++k)
        for (int d = 0; d < 3; ++d) x[k][d][l] = view.rough[3 * std::size_t(t[k]) + d] + above[d];
    }
  }

  /// Clears the lanes that cannot have a lattice point between their least and largest
  /// x_other - slope x_axis.
  void drop_between(int other, float slope, int axis, int* lane) const {
    constexpr float margin = 4e-3f, above = 16384;  // cells: of rounding
    for (int l = 0; l < lanes; ++l) {
      const float u0 = x[0][other][l] - slope * x[0][axis][l], u1 = x[1][other][l] - slope * x[1][axis][l],
                  u2 = x[2][other][l] - slope * x[2][axis][l];
      const float low = std::min(std::min(u0, u1), u2), high = std::max(std::max(u0, u1), u2);
      lane[l] &= int(high + (above + margin)) > int(low + (above - margin)) ? -1 : 0;
    }
  }
  /// Bit l: whether lane l may meet one of the lines.
  unsigned near(const Lines& lines) const {
    int lane[lanes];
    std::fill_n(lane, lanes, -1);
    drop_between(lines.a, float(lines.c_a), lines.axis, lane);
    drop_between(lines.b, float(lines.c_b), lines.axis, lane);
    unsigned bits = 0;
    for (int l = 0; l < lanes; ++l) bits |= unsigned(lane[l] & 1) << l;
    return bits;
  }
};

/// The lines along one of a half of the directions, and which of them pass cells of a box.
struct LinesInBox {
  Lines lines;
  Range us, vs, ws;

  LinesInBox(int direction, Int3 low, Int3 high) : lines(direction) {
    const auto range = [&](int d, int slope) {
      const int first = slope * low[lines.axis], last = slope * high[lines.axis];
      return Range{low[d] - std::max(first, last), high[d] - std::min(first, last)};
    };
    us = range(lines.a, lines.c_a), vs = range(lines.b, lines.c_b);
    ws = {low[lines.axis], high[lines.axis]};
  }
};

/// Calls visit(lines, u, v, w) for all crossings of the triangles with lines that pass cells of a box, along
/// `directions` of the half.
template <Touching touching, class Visit>
void for_crossings(const TriangleView& view, int directions, Int3 low, Int3 high, Visit&& visit) {
  const auto lines = [&](int k) { return LinesInBox(2 * k + 1, low, high); };
  const LinesInBox all[] = {lines(0), lines(1), lines(2), lines(3), lines(4),
                            lines(5), lines(6), lines(7), lines(8)};
  float above[3];
  for (int d = 0; d < 3; ++d) above[d] = float(view.base[d] - low[d]);
  for (std::size_t first = 0; first < view.count; first += lanes) {
    const int n = int(std::min<std::size_t>(lanes, view.count - first));
    const RoughTriangles rough(view, first, n, above);
    for (int k = 0; k < directions; ++k) {
      const LinesInBox& box = all[k];
      for (unsigned left = rough.near(box.lines) & ((1u << n) - 1); left != 0; left &= left - 1) {
        const auto& t = view.triangles[view.wanted[first + std::size_t(std::countr_zero(left))]];
        const SeenTriangle seen(view.corner[t[0]], view.corner[t[1]], view.corner[t[2]], box.lines);
        const Range u = box.us.within(seen.u_range()), v = box.vs.within(seen.v_range());
        if (u.empty() || v.empty()) continue;
        seen.meet<touching>(
            u, v, [&](std::int64_t at_u, std::int64_t at_v, std::int64_t w) { visit(box, at_u, at_v, w); });
      }
    }
  }
}

void mark_changes(const TriangleView& view, const BitFrame& frame, Int3 low, std::uint64_t* words) {
  const Int3 first = low + Int3{2, 2, 2}, last = low + frame.size - Int3{3, 3, 3};
  for_crossings<Touching::is_moved>(
      view, 1, first, last, [&](const LinesInBox&, std::int64_t y, std::int64_t z, std::int64_t w) {
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
  for_crossings<Touching::counts>(
      view, (lbm::directions - 1) / 2, low, high,
      [&](const LinesInBox& box, std::int64_t u, std::int64_t v, std::int64_t w) {
        for (std::int64_t k = (w - rounding) >> cell_bits; k <= (w + rounding) >> cell_bits; ++k) {
          const Int3 from = box.lines.cell(u, v, k) - low, to = box.lines.cell(u, v, k + 1) - low;
          if (!within(links.frame, from) || !within(links.frame, to)) continue;
          const std::size_t bit_from = bit_of(links.frame, from), bit_to = bit_of(links.frame, to);
          const std::int64_t distance = std::clamp<std::int64_t>(w - k * cell_units, 0, cell_units);
          note(bit_from, bit_to, box.lines.forward, distance);
          note(bit_to, bit_from, box.lines.backward, cell_units - distance);
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

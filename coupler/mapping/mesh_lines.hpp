#pragma once
// Where lines of lattice points meet a triangle: in whole numbers, so that neither blocks nor ranks nor
// instruction sets have a say. Only for *_kernel.cpp files, which are built once an instruction set
// (SILT_ISA).
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>

#include "coupler/mapping/mesh_kernels.hpp"
#include "lbm/lattice.hpp"

namespace silt::coupler::SILT_ISA {

/// The nearest whole number, of numbers below 2^51; the same with every instruction set.
inline std::int64_t to_whole(double x) {
  constexpr double rounder = 0x1.8p52;  // the low bits of a sum with it are those of the whole number
  const double sum = x + rounder;
  std::int64_t bits, zero;
  std::memcpy(&bits, &sum, sizeof bits), std::memcpy(&zero, &rounder, sizeof zero);
  return bits - zero;
}

/// The lines along a direction c: through the lattice points (u, v, w) whose coordinates are w along an axis,
/// and u + c_a w and v + c_b w along the others, for all w.
struct Lines {
  int axis = 0, a = 0, b = 0, c_a = 0, c_b = 0;
  int forward = 0, backward = 0;  // the directions i that run along them, to greater and to less w

  constexpr explicit Lines(int direction) {
    const lbm::Int3 c = lbm::c[direction];
    axis = c.x != 0 ? 0 : c.y != 0 ? 1 : 2;
    a = (axis + 1) % 3, b = (axis + 2) % 3;
    const bool reversed = c[axis] < 0;
    c_a = reversed ? -c[a] : c[a], c_b = reversed ? -c[b] : c[b];
    forward = reversed ? lbm::opposite(direction) : direction, backward = lbm::opposite(forward);
  }
  lbm::Int3 cell(std::int64_t u, std::int64_t v, std::int64_t w) const {
    lbm::Int3 x;
    x[axis] = int(w), x[a] = int(u + c_a * w), x[b] = int(v + c_b * w);
    return x;
  }
};

/// Lattice points u or v of lines.
struct Range {
  std::int64_t first, last;
  bool empty() const { return first > last; }
  Range within(const Range& o) const { return {std::max(first, o.first), std::min(last, o.last)}; }
};

/// How a line that only touches a triangle counts: met by every triangle that it touches, or as if it were a
/// little further along u and less along v, which meets a closed surface an even number of times.
enum class Touching { counts, is_moved };

/// A triangle seen along lines: its corners in their coordinates u, v, w, in units.
class SeenTriangle {
 public:
  [[gnu::always_inline]] SeenTriangle(const Whole3& p, const Whole3& q, const Whole3& r, const Lines& lines) {
    const Whole3* const corners[] = {&p, &q, &r};
    for (int k = 0; k < 3; ++k) {
      const Whole3& x = *corners[k];
      w_[k] = x[lines.axis];
      u_[k] = x[lines.a] - lines.c_a * w_[k];
      v_[k] = x[lines.b] - lines.c_b * w_[k];
    }
  }
  /// Lattice points in its range of u, or of v.
  [[gnu::always_inline]] Range u_range() const { return points_between(u_); }
  [[gnu::always_inline]] Range v_range() const { return points_between(v_); }

  /// Calls visit(u, v, w) for the lines of the ranges that it meets: u, v of the line, w in units where.
  template <Touching touching, class Visit>
  void meet(const Range& us, const Range& vs, Visit&& visit) const {
    constexpr std::int64_t most = std::int64_t{1} << 30;  // of differences: their products fit 64 bits
    __extension__ using Wide = __int128;
    if (extent(u_) < most && extent(v_) < most)
      meet_lines<std::int64_t, touching>(us, vs, visit);
    else
      meet_lines<Wide, touching>(us, vs, visit);
  }

 private:
  static std::int64_t least(const Whole3& x) { return std::min(std::min(x[0], x[1]), x[2]); }
  static std::int64_t largest(const Whole3& x) { return std::max(std::max(x[0], x[1]), x[2]); }
  static std::int64_t extent(const Whole3& x) { return largest(x) - least(x); }
  [[gnu::always_inline]] static Range points_between(const Whole3& x) {
    return {(least(x) + cell_units - 1) >> cell_bits, largest(x) >> cell_bits};
  }

  /// An edge from one corner to the next, in units.
  struct Edge {
    std::int64_t low, high;  // of v
    double u, v, slope;      // a corner; du/dv; infinite: along u
  };
  struct Edges {
    Edge of[3];

    explicit Edges(const SeenTriangle& t) {
      for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3;
        const double along_u = double(t.u_[l] - t.u_[k]), along_v = double(t.v_[l] - t.v_[k]);
        of[k] = {std::min(t.v_[k], t.v_[l]), std::max(t.v_[k], t.v_[l]), double(t.u_[k]), double(t.v_[k]),
                 along_v == 0 ? 0 : along_u / along_v};
      }
    }
    /// Of a row v, the lattice points u between them, to rounding. (An edge along the row lies between ends
    /// of the other two.)
    Range row(std::int64_t v, const Range& all) const {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      const std::int64_t at = v << cell_bits;
      for (const Edge& edge : of) {
        if (edge.high < at || edge.low > at || edge.low == edge.high) continue;
        const double u = edge.u + edge.slope * (double(at) - edge.v);
        low = std::min(low, u), high = std::max(high, u);
      }
      if (!(low <= high)) return {0, -1};
      constexpr std::int64_t rounding = 4;  // units
      return all.within({(to_whole(low) - rounding + cell_units - 1) >> cell_bits,
                         (to_whole(high) + rounding) >> cell_bits});
    }
  };

  template <class Int, Touching touching, class Visit>
  void meet_lines(const Range& us, const Range& vs, Visit&& visit) const {
    if (us.first == us.last) {
      for (std::int64_t v = vs.first; v <= vs.last; ++v) meet_line<Int, touching>(us.first, v, visit);
      return;
    }
    const Edges edges(*this);
    for (std::int64_t v = vs.first; v <= vs.last; ++v) {
      const Range in_row = edges.row(v, us);
      for (std::int64_t u = in_row.first; u <= in_row.last; ++u) meet_line<Int, touching>(u, v, visit);
    }
  }
  template <class Int, Touching touching, class Visit>
  void meet_line(std::int64_t u, std::int64_t v, Visit&& visit) const {
    Int ru[3], rv[3], side[3];
    for (int k = 0; k < 3; ++k) ru[k] = u_[k] - (u << cell_bits), rv[k] = v_[k] - (v << cell_bits);
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3, m = (k + 2) % 3;
      side[k] = ru[l] * rv[m] - ru[m] * rv[l];
    }
    if (meets<touching>(side, ru, rv)) visit(u, v, where(side));
  }
  /// side[k]: on which side of the edge opposite to corner k the line passes; ru, rv: the corners from it.
  template <Touching touching, class Int>
  static bool meets(const Int (&side)[3], const Int (&ru)[3], const Int (&rv)[3]) {
    if constexpr (touching == Touching::counts) {
      const bool left = side[0] >= 0 && side[1] >= 0 && side[2] >= 0;
      const bool right = side[0] <= 0 && side[1] <= 0 && side[2] <= 0;
      return (left || right) && side[0] + side[1] + side[2] != 0;
    }
    int sign[3];
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3, m = (k + 2) % 3;
      const Int moved = side[k] != 0 ? side[k] : rv[m] != rv[l] ? rv[l] - rv[m] : ru[m] - ru[l];
      sign[k] = (moved > 0) - (moved < 0);
    }
    return sign[0] != 0 && sign[0] == sign[1] && sign[1] == sign[2];
  }
  /// Rounded to a unit, between the corners.
  template <class Int>
  std::int64_t where(const Int (&side)[3]) const {
    const double area = double(side[0]) + double(side[1]) + double(side[2]);
    const double from_first =
        (double(side[1]) * double(w_[1] - w_[0]) + double(side[2]) * double(w_[2] - w_[0])) / area;
    return std::clamp(w_[0] + to_whole(from_first), least(w_), largest(w_));
  }

  Whole3 u_, v_, w_;
};

}  // namespace silt::coupler::SILT_ISA

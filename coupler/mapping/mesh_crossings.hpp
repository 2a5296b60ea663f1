#pragma once
// Where the lines of lattice points meet the triangles of a mesh: in whole numbers, so that neither blocks
// nor ranks nor instruction sets have a say. All lines of one direction c at a time, and of the triangles
// only those near a block.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "lbm/block.hpp"
#include "lbm/lattice.hpp"
#include "rigid/math/types.hpp"
#include "rigid/shapes/triangle_mesh.hpp"

namespace silt::coupler {

/// One cell is so many units; the centre of cell 0 of the domain is at 0.
inline constexpr int cell_bits = 24;
inline constexpr std::int64_t cell_units = std::int64_t{1} << cell_bits;

using Whole3 = std::array<std::int64_t, 3>;

/// A mesh at a pose, its corners rounded to whole units: the same in every block.
class PlacedMesh {
 public:
  /// Keeps a reference to the mesh.
  void place(const rigid::TriangleMesh&, const rigid::Pose&);
  /// Triangles whose boxes overlap a box of cells (an image of the domain's), and perhaps some near it.
  const std::vector<std::uint32_t>& near(const rigid::Vec3& low, const rigid::Vec3& high);
  /// In cells, as they are counted in `near`.
  rigid::BoundingBox box() const;
  /// Of a triangle that `near` has given.
  std::array<Whole3, 3> corners(std::uint32_t triangle) const {
    const rigid::TriangleMesh::Triangle& t = mesh_->triangles()[triangle];
    return {corner_[t[0]], corner_[t[1]], corner_[t[2]]};
  }

 private:
  void round_corners(std::uint32_t triangle);

  const rigid::TriangleMesh* mesh_ = nullptr;
  rigid::Pose pose_;
  std::vector<Whole3> corner_;
  std::vector<char> rounded_;
  std::vector<std::uint32_t> near_;
};

/// The lines along a direction c that is one of a half: through the lattice points (u, v, w) whose
/// coordinates are w along an axis, and u + c_a w and v + c_b w along the others, for all w.
struct Lines {
  int axis, a, b, c_a, c_b;
  int forward, backward;  // the directions i that run along them, to greater and to less w

  explicit Lines(int direction) {
    lbm::Int3 c = lbm::c[direction];
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
  SeenTriangle(const std::array<Whole3, 3>& corners, const Lines& lines) {
    for (int k = 0; k < 3; ++k) {
      w_[k] = corners[k][lines.axis];
      u_[k] = corners[k][lines.a] - lines.c_a * w_[k];
      v_[k] = corners[k][lines.b] - lines.c_b * w_[k];
    }
  }
  /// Lattice points in its range of u, or of v.
  Range u_range() const { return points_between(u_); }
  Range v_range() const { return points_between(v_); }

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
  static std::int64_t extent(const Whole3& x) {
    return std::max({x[0], x[1], x[2]}) - std::min({x[0], x[1], x[2]});
  }
  static Range points_between(const Whole3& x) {
    return {(std::min({x[0], x[1], x[2]}) + cell_units - 1) >> cell_bits,
            std::max({x[0], x[1], x[2]}) >> cell_bits};
  }

  /// Of a row v, the lattice points u between its edges, and one more on either side.
  Range row(std::int64_t v, const Range& all) const {
    constexpr std::int64_t few = 4;  // not worth it
    if (all.last - all.first < few) return all;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    const double at = double(v << cell_bits);
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3;
      const double a = double(v_[k]), b = double(v_[l]);
      if (std::max(a, b) < at || std::min(a, b) > at) continue;
      const double share = a == b ? 0 : (at - a) / (b - a);
      const double u = double(u_[k]) + share * double(u_[l] - u_[k]);
      low = std::min({low, u, a == b ? double(u_[l]) : u}),
      high = std::max({high, u, a == b ? double(u_[l]) : u});
    }
    if (!(low <= high)) return {0, -1};
    return all.within(
        {std::int64_t(std::floor(low / cell_units)) - 1, std::int64_t(std::ceil(high / cell_units)) + 1});
  }

  template <class Int, Touching touching, class Visit>
  void meet_lines(const Range& us, const Range& vs, Visit&& visit) const {
    for (std::int64_t v = vs.first; v <= vs.last; ++v) {
      const Range in_row = row(v, us);
      for (std::int64_t u = in_row.first; u <= in_row.last; ++u) {
        Int ru[3], rv[3], side[3];
        for (int k = 0; k < 3; ++k) ru[k] = u_[k] - (u << cell_bits), rv[k] = v_[k] - (v << cell_bits);
        for (int k = 0; k < 3; ++k) {
          const int l = (k + 1) % 3, m = (k + 2) % 3;
          side[k] = ru[l] * rv[m] - ru[m] * rv[l];
        }
        if (meets<touching>(side, ru, rv)) visit(u, v, where(side));
      }
    }
  }
  /// side[k]: on which side of the edge opposite to corner k the line passes; ru, rv: the corners from it.
  template <Touching touching, class Int>
  static bool meets(const Int (&side)[3], const Int (&ru)[3], const Int (&rv)[3]) {
    if (touching == Touching::counts) {
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
    const auto [low, high] = std::minmax({w_[0], w_[1], w_[2]});
    const double from_first =
        (double(side[1]) * double(w_[1] - w_[0]) + double(side[2]) * double(w_[2] - w_[0])) / area;
    return std::clamp(w_[0] + std::int64_t(std::llround(from_first)), low, high);
  }

  Whole3 u_, v_, w_;
};

}  // namespace silt::coupler

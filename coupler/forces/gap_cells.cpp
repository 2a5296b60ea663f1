#include "coupler/forces/gap_cells.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rigid/bodies/lubrication.hpp"

namespace silt::coupler {

namespace {

using rigid::Mat3;

constexpr double widest = 1;    // cells: largest gap that its cells do not resolve
constexpr double furthest = 8;  // cells from the middle, for nearly flat surfaces

double sum_over(const GapOnLattice& gap) {
  return SILT_CHOSEN(sum_over_gap)(gap);
}

/// The principal curvatures of a surface.
struct Principal {
  double least, most;

  explicit Principal(const Mat3& curvature) {
    const double sum = curvature.trace();
    const double apart = std::sqrt(std::max(0.0, 2 * curvature.squaredNorm() - sum * sum));
    least = std::max(0.0, 0.5 * (sum - apart));
    most = 0.5 * (sum + apart);
  }
};

/// Returns the form of a surface with the lattice axes in the order x, y, z.
SurfaceFall fall_of(const Mat3& k, int x, int y, int z) {
  return {0.5 * k(x, x), 0.5 * k(y, y), 0.5 * k(z, z), k(x, y), k(y, z), k(z, x)};
}

/// Returns the largest fraction of the gap's widening, away from the middle, that is due to one surface.
double largest_share(const Principal& of, const Principal& other) {
  return of.most / (of.most + other.least);
}

/// Sets the bounds, along the normal and around the middle, where the gap is narrower than a cell.
void set_heights(GapOnLattice& g, const Mat3& a, const Mat3& b) {
  const Principal k_a(a), k_b(b);
  const double room = widest - 2 * g.half_width;
  g.lowest = -(g.half_width + room * largest_share(k_a, k_b));
  const double highest = g.half_width + room * largest_share(k_b, k_a);
  g.column = 1 + static_cast<int>((highest - g.lowest) / g.normal[0]);
  const Principal both(a + b);
  const double radius = std::sqrt(2 * room / both.least), height = std::max(-g.lowest, highest);
  const auto extent = [&](double n) {
    return radius < furthest ? radius * std::sqrt(1 - n * n) + std::abs(n) * height : furthest + widest;
  };
  g.extent_y = extent(g.normal[1]);
  g.extent_z = extent(g.normal[2]);
}

}  // namespace

double cells_in_gap(const rigid::LubricatedGap& gap) {
  const double product = gap.curvature_product();
  if (gap.width >= widest || product <= 0) return 0;
  int x = 0;
  gap.normal.cwiseAbs().maxCoeff(&x);
  const int axes[3] = {x, (x + 1) % 3, (x + 2) % 3};
  const bool turned = gap.normal[x] < 0;
  const Mat3 &a = turned ? gap.curvature_b : gap.curvature_a, &b = turned ? gap.curvature_a : gap.curvature_b;
  GapOnLattice g;
  g.half_width = 0.5 * gap.width;
  for (int d = 0; d < 3; ++d) {
    g.normal[d] = turned ? -gap.normal[axes[d]] : gap.normal[axes[d]];
    g.offset[d] = gap.middle[axes[d]] - 0.5;
  }
  g.a = fall_of(a, axes[0], axes[1], axes[2]);
  g.b = fall_of(b, axes[0], axes[1], axes[2]);
  set_heights(g, a, b);
  return sum_over(g) * std::sqrt(product) / (2 * std::numbers::pi);
}

}  // namespace silt::coupler

// Built once for each instruction set. It always sums eight columns along x at a time, in the same order.
#include <cmath>

#include "coupler/forces/gap_cells.hpp"
#include "cpu/lanes.hpp"

namespace silt::coupler::SILT_BUILD {

namespace {

constexpr int lanes = 8;
using Real8 = VectorOf<double, lanes>::type;

/// Returns the least integer >= x, for |x| < 2^51.
Real8 whole_above(const Real8& x) {
  constexpr double round = 0x1.8p52;
  const Real8 nearest = (x + round) - round;
  return nearest < x ? nearest + 1 : nearest;
}

/// A surface over columns (y, z): its distance at x from the plane through the gap's middle, and its slope.
struct Surface {
  Real8 here, slope;
  double curvature;

  Surface(const SurfaceFall& f, double half_width, double y, const Real8& z)
      : here((half_width + f.yy * y * y) + z * (f.yz * y + f.zz * z)),
        slope(f.xy * y + f.zx * z),
        curvature(f.xx) {}
  Real8 at(const Real8& x) const { return here + x * (slope + x * curvature); }
};

/// Returns the sum of (1 - H)^2 over the columns' cells in the gap.
Real8 columns(const GapOnLattice& g, double y, const Real8& z) {
  const Surface a(g.a, g.half_width, y, z), b(g.b, g.half_width, y, z);
  const Real8 height = g.normal[1] * y + g.normal[2] * z;
  Real8 x = whole_above((g.lowest - height) / g.normal[0] + g.offset[0]) - g.offset[0], sum{};
  for (int k = 0; k < g.column; ++k, x += 1) {
    const Real8 s = height + g.normal[0] * x, below = a.at(x), above = b.at(x);
    const Real8 missing = 1 - (below + above);
    const auto in_gap = (s > -below) & (s < above) & (missing > 0);
    sum += in_gap ? missing * missing : Real8{};
  }
  return sum;
}

}  // namespace

double sum_over_gap(const GapOnLattice& g) {
  const Real8 lane = {0, 1, 2, 3, 4, 5, 6, 7};
  const double first_y = std::ceil(g.offset[1] - g.extent_y) - g.offset[1];
  const double first_z = std::ceil(g.offset[2] - g.extent_z) - g.offset[2];
  Real8 sums{};
  for (double y = first_y; y <= g.extent_y; y += 1)
    for (double z = first_z; z <= g.extent_z; z += lanes) sums += columns(g, y, z + lane);
  double sum = 0;
  for (int l = 0; l < lanes; ++l) sum += sums[l];
  return sum;
}

}  // namespace silt::coupler::SILT_BUILD

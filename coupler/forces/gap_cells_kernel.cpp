// Built once an instruction set. Eight columns along x at a time, whatever the vectors of the machine, so
// that all builds sum in one order.
#include <cmath>

#include "coupler/forces/gap_kernels.hpp"
#include "lbm/isa_vector.hpp"

namespace silt::coupler::SILT_ISA {

namespace {

constexpr int lanes = 8;
using Lanes = lbm::SILT_ISA::VectorOf<double, lanes>::type;

/// The least whole number that is not below x; of less than 2^51.
Lanes whole_above(const Lanes& x) {
  constexpr double round = 0x1.8p52;
  const Lanes nearest = (x + round) - round;
  return nearest < x ? nearest + 1 : nearest;
}

/// A surface over columns (y, z): its distance from the plane through the gap's middle, at x.
struct Surface {
  Lanes here, slope;
  double bend;

  Surface(const Fall& f, double half_width, double y, const Lanes& z)
      : here((half_width + f.yy * y * y) + z * (f.yz * y + f.zz * z)),
        slope(f.xy * y + f.zx * z),
        bend(f.xx) {}
  Lanes at(const Lanes& x) const { return here + x * (slope + x * bend); }
};

/// Sum of (1 - H)^2 of the columns' cells in the gap.
Lanes columns(const GapOnLattice& g, double y, const Lanes& z) {
  const Surface a(g.a, g.half_width, y, z), b(g.b, g.half_width, y, z);
  const Lanes height = g.normal[1] * y + g.normal[2] * z;
  Lanes x = whole_above((g.lowest - height) / g.normal[0] + g.offset[0]) - g.offset[0], sum{};
  for (int k = 0; k < g.column; ++k, x += 1) {
    const Lanes s = height + g.normal[0] * x, below = a.at(x), above = b.at(x);
    const Lanes missing = 1 - (below + above);
    const auto in_gap = (s > -below) & (s < above) & (missing > 0);
    sum += in_gap ? missing * missing : Lanes{};
  }
  return sum;
}

}  // namespace

double sum_over_gap(const GapOnLattice& g) {
  const Lanes lane = {0, 1, 2, 3, 4, 5, 6, 7};
  const double first_y = std::ceil(g.offset[1] - g.extent_y) - g.offset[1];
  const double first_z = std::ceil(g.offset[2] - g.extent_z) - g.offset[2];
  Lanes sums{};
  for (double y = first_y; y <= g.extent_y; y += 1)
    for (double z = first_z; z <= g.extent_z; z += lanes) sums += columns(g, y, z + lane);
  double sum = 0;
  for (int l = 0; l < lanes; ++l) sum += sums[l];
  return sum;
}

}  // namespace silt::coupler::SILT_ISA

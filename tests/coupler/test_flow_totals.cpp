// What the whole fluid holds, at sizes that a 64-bit sum of quanta cannot.
#include <gtest/gtest.h>

#include "coupler/flow_totals.hpp"
#include "coupler/mapping/for_cells.hpp"
#include "lbm/fluid.hpp"

namespace silt::coupler {
namespace {

// 320^3 cells at a speed of 0.3 hold a momentum of 9.8e6 lattice units; 2^63 quanta are 8.4e6.
TEST(FlowTotals, OfAsMuchMomentumAsALargeFastFlowHas) {
  constexpr lbm::Int3 cells{320, 320, 320};
  constexpr double speed = 0.3125, deviation = -0.28125;  // whole numbers of quanta: the sums are exact
  lbm::Moments m;
  m.density_deviation = deviation;
  m.momentum[0] = speed, m.momentum[2] = -speed;
  FlowSums sums(cells);
  for_cells({}, cells, [&](lbm::Int3 x) { sums.add(x, m, {speed, 0, -speed}); });
  const FlowTotals totals = sums.over_ranks(MPI_COMM_SELF);
  const double count = 320. * 320. * 320.;
  EXPECT_EQ(double(totals.fluid_cells), count);
  EXPECT_EQ(totals.mass_deviation, count * deviation);
  EXPECT_EQ(totals.momentum[0], count * speed);
  EXPECT_EQ(totals.momentum[1], 0);
  EXPECT_EQ(totals.momentum[2], -count * speed);
}

TEST(FlowTotals, NameTheFirstCellThatIsNotANumber) {
  FlowSums sums({4, 5, 6});
  lbm::Moments good, bad;
  bad.density_deviation = std::numeric_limits<double>::quiet_NaN();
  sums.add({1, 2, 3}, bad, {0, 0, 0});
  sums.add({3, 1, 3}, bad, {0, 0, 0});
  sums.add({0, 0, 0}, good, {0, 0, 0});
  const FlowTotals totals = sums.over_ranks(MPI_COMM_SELF);
  EXPECT_FALSE(totals.finite);
  EXPECT_EQ(totals.bad_cell, (lbm::Int3{3, 1, 3}));
  EXPECT_EQ(totals.fluid_cells, 1u);
}

}  // namespace
}  // namespace silt::coupler

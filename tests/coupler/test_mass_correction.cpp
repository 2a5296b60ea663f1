// The account of the fluid's mass, by arithmetic, in a box larger than any machine here holds.
#include "coupler/flow_account.hpp"

#include <gtest/gtest.h>

#include "coupler/fluid_fields.hpp"
#include "lbm/cut_links.hpp"

namespace silt::coupler {
namespace {

constexpr std::uint64_t all_cells = 1'000'000'000'000;

rigid::FixedSum quanta(double mass) {
  return rigid::FixedSum(mass / lbm::mass_quantum);
}

/// 2^63 quanta are 8.4e6: 64 bits would have turned the sign.
TEST(MassCorrection, TakesOutASurplusOfAThousandthOfATrillionCells) {
  MassCorrection correction;
  correction.recount({all_cells, quanta(1e9)});
  EXPECT_DOUBLE_EQ(correction.take_surplus(1), -1e-3);
  EXPECT_EQ(correction.state().surplus, 0);
}

TEST(MassCorrection, SumsWhatLinksAndCellsOfATrillionBring) {
  MassCorrection correction;
  correction.recount({all_cells, 0});
  correction.end_step({quanta(3e8), quanta(-1e8), -1'000'000'000});
  EXPECT_EQ(correction.state().surplus, quanta(2e8));
  EXPECT_EQ(correction.state().fluid_cells, std::int64_t(all_cells) - 1'000'000'000);
  // what is known, and as much again as links brought in the last step
  EXPECT_DOUBLE_EQ(correction.take_surplus(1), -5e8 / double(all_cells - 1'000'000'000));
}

TEST(MassCorrection, IsSpreadOverTheStepsOfTheCoarsestCells) {
  MassCorrection correction;
  correction.recount({all_cells, quanta(4e8)});
  EXPECT_DOUBLE_EQ(correction.take_surplus(4), -1e8 / double(all_cells));
  for (int step = 0; step < 3; ++step) {
    correction.end_step({quanta(1e7), 0, 0});
    EXPECT_DOUBLE_EQ(correction.take_surplus(4), -1e8 / double(all_cells));  // what coarse cells were given
  }
  correction.end_step({quanta(1e7), 0, 0});
  EXPECT_EQ(correction.state().surplus, quanta(4e7));
  EXPECT_DOUBLE_EQ(correction.take_surplus(4), -2e7 / double(all_cells));  // and what links will bring
}

TEST(MassCorrection, CountsACellAsItsDensity) {
  MassCorrection correction;
  correction.gain_cells(1, 0.25);
  correction.gain_cells(-1, -0.5);
  const MassCorrection::Gain gain = correction.take_gain(7);
  EXPECT_EQ(gain.cell_mass, quanta(0.75));
  EXPECT_EQ(gain.link_mass, 7);
  EXPECT_EQ(gain.cells, 0);
}

}  // namespace
}  // namespace silt::coupler

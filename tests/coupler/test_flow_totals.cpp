// The sums of the whole fluid, at sizes that a 64-bit sum of quanta cannot hold.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "coupler/flow_account.hpp"
#include "coupler/flow_totals.hpp"
#include "coupler/fluid_fields.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "lbm/fluid.hpp"
#include "lbm/walls/cut_links.hpp"
#include "silt/simulation.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::coupler {
namespace {

// 320^3 cells at a speed of 0.3 hold a momentum of 9.8e6 lattice units; 2^63 quanta are 8.4e6.
TEST(FlowTotals, OfAsMuchMomentumAsALargeFastFlowHas) {
  constexpr lbm::Int3 cells{320, 320, 320};
  constexpr double speed = 0.3125,
                   deviation = -0.28125;  // whole numbers of quanta: the sums are exact
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

/// Runs of fluid cells, added up together, hold what the cells do one by one; solid ones do not count.
template <class T>
void expect_runs_to_be_their_cells() {
  constexpr double near = std::max(4. * std::numeric_limits<T>::epsilon(), 1e-14);  // of a cell
  constexpr lbm::Int3 cells{150, 5, 4};
  lbm::Fluid<T> fluid(lbm::Domain(cells, {}, std::nullopt, 1),
                      {0.8, 3. / 16, lbm::Collision::trt, {1e-4, 0, 2e-5}}, MPI_COMM_SELF);
  BlockMap map;
  map.box = {{}, cells};
  map.solid = CellBits(cells);
  std::mt19937 random(3);
  std::uniform_real_distribution<> any(-0.02, 0.02);
  FlowSums one_by_one(cells);
  for_cells({}, cells, [&](lbm::Int3 x) {
    const bool solid = x.z < 3 && (x.y == 2 || (x.x + 3 * x.y) % 71 < x.z * 20 || (x.y == 3 && x.x > 140));
    if (solid) map.solid.set(x);
    for (int i = 0; i < lbm::D3Q19::directions; ++i)
      fluid.arriving(0, x, i) = T(solid ? std::nan("") : any(random));
    if (x == lbm::Int3{30, 1, 1} || x == lbm::Int3{99, 0, 0}) {  // two alike: the first is told
      for (int i = 0; i < lbm::D3Q19::directions; ++i) fluid.arriving(0, x, i) = T(i == 2 ? -0.5 : 0);
    }
    const lbm::Moments m = fluid.moments(0, x);
    if (!solid) one_by_one.add(x, m, fluid.velocity(m));
  });
  const FlowTotals a = flow_sums(fluid, std::span(&map, 1)).over_ranks(MPI_COMM_SELF);
  const FlowTotals b = one_by_one.over_ranks(MPI_COMM_SELF);
  EXPECT_EQ(a.fluid_cells, b.fluid_cells);
  const double count = double(b.fluid_cells);
  EXPECT_NEAR(a.mass_deviation, b.mass_deviation, count * near);
  for (int d = 0; d < 3; ++d) EXPECT_NEAR(a.momentum[d], b.momentum[d], count * near);
  EXPECT_NEAR(a.energy, b.energy, count * near);
  EXPECT_NEAR(a.max_speed, b.max_speed, near);
  EXPECT_NEAR(a.min_density, b.min_density, near);
  EXPECT_NEAR(a.max_density, b.max_density, near);
  EXPECT_NEAR(a.density_deviation, b.density_deviation, near);
  EXPECT_TRUE(a.finite);
  EXPECT_EQ(a.fastest_cell, (lbm::Int3{99, 0, 0}));
  EXPECT_EQ(a.thinnest_cell, (lbm::Int3{99, 0, 0}));
}

TEST(FlowTotals, OfRunsAreThoseOfTheirCells) {
  expect_runs_to_be_their_cells<float>();
  expect_runs_to_be_their_cells<double>();
}

/// Totals are counted once between two changes and again after each: a
/// uniform force adds itself in every step, to a fluid without bodies too.
TEST(FlowTotals, FollowTheSteps) {
  testing::CaseText c;
  c.domain = testing::domain_of({8, 6, 4});
  c.fluid = "[fluid]\nrelaxation_time = 0.8\nprecision = \"double\"\nbody_force = [1e-6, 0, 0]\n";
  c.shapes = c.bodies = "";
  Simulation s = c.start(MPI_COMM_SELF);
  for (int step = 0; step < 4; ++step, s.step()) {
    const double speed = (step + 0.5) * 1e-6;
    const FlowTotals totals = s.scene().flow->totals();
    EXPECT_NEAR(s.scene().flow->fields().velocity_sum(totals)[0] / (192 * speed), 1, 1e-7);
    EXPECT_NEAR(totals.energy / (192 * speed * speed / 2), 1, 1e-7);
  }
}

TEST(FlowTotals, OfSlowFlowHaveItsEnergyToTheLastDigits) {
  constexpr lbm::Int3 cells{40, 3, 2};
  constexpr double speed = 1e-9;
  lbm::Moments m;
  m.momentum[1] = speed;
  FlowSums sums(cells);
  for_cells({}, cells, [&](lbm::Int3 x) { sums.add(x, m, {0, speed, 0}); });
  const FlowTotals totals = sums.over_ranks(MPI_COMM_SELF);
  EXPECT_NEAR(totals.energy / (240 * 0.5 * speed * speed), 1, 1e-6);
  EXPECT_NEAR(totals.momentum[1] / (240 * speed), 1, 2e-6);
}

}  // namespace
}  // namespace silt::coupler

// The temperature on any number of ranks: the same bits for every cut into blocks.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "lbm/blocks/equal_cut.hpp"
#include "tests/lbm/heat/stirred_heat.hpp"
#include "tests/odd_cut.hpp"
#include "tests/world.hpp"

namespace silt::lbm {
namespace {

using testing::no_slip;
using testing::periodic;
using testing::Velocity;
using tests::ranks;

template <class T>
std::uint64_t stirred_heat(const CutTree& tree, bool periodic_rows, MPI_Comm comm, int ranks, bool in_parts) {
  SideCondition across = periodic_rows ? periodic : no_slip, warm{SideKind::temperature},
                open{SideKind::open};
  warm.value = 2;
  Fluid<T> fluid(Domain(tree, {across, across, periodic, periodic, no_slip, no_slip}, ranks),
                 {0.6, 3. / 16, Collision::trt, {1e-5, 2e-5, 0}}, comm);
  const SideCondition low = periodic_rows ? periodic : heat_side(0, 0.01),
                      high = periodic_rows ? periodic : open;
  Temperature<T> heat(fluid, {0.03, {0, 0, 1e-4}}, {low, high, periodic, periodic, warm, heat_side(5)});
  testing::set(
      fluid, heat, [](Int3 g) { return std::sin(g.x + 2. * g.y + g.z); },
      [](Int3 g) {
        return Velocity{0.02 * std::sin(3. * g.z), 0.01, 0.01 * std::cos(2. * g.x)};
      });
  for (int t = 0; t < 21; ++t) {
    if (in_parts) {
      fluid.begin_pass();
      for (int b = 0; b < int(fluid.blocks().size()); ++b)
        for (int part = 0; part < fluid.parts(b); ++part) fluid.collide(b, part);
      fluid.end_pass();
      fluid.exchange();
    } else {
      testing::step(fluid);
    }
  }
  std::uint64_t sum = 0, all = 0;
  testing::for_all_cells(fluid, [&](int b, Int3 x, Int3 g) {
    for (int i = 0; i < D3Q7::directions; ++i) {
      std::uint64_t h = std::bit_cast<std::uint64_t>(double(heat.arriving(b, x, i)));
      h ^= std::uint64_t(((g.z * 1009 + g.y) * 1009 + g.x) * 7 + i) * 0x9E3779B97F4A7C15u;
      h ^= h >> 31, h *= 0xBF58476D1CE4E5B9u, h ^= h >> 29;
      sum += h;
    }
  });
  MPI_Allreduce(&sum, &all, 1, MPI_UINT64_T, MPI_SUM, comm);
  return all;
}

template <class T>
void is_the_same_for_every_cut() {
  const Int3 cells{21, 11, 16};
  for (const bool periodic_rows : {true, false}) {
    const std::uint64_t alone =
        stirred_heat<T>(grid_cut(cells, cells), periodic_rows, MPI_COMM_SELF, 1, false);
    EXPECT_EQ(alone, stirred_heat<T>(grid_cut(cells, cells), periodic_rows, MPI_COMM_SELF, 1, true));
    for (const Int3 size : {Int3{21, 11, 2}, Int3{8, 6, 2}})
      EXPECT_EQ(alone, stirred_heat<T>(grid_cut(cells, size), periodic_rows, MPI_COMM_WORLD, ranks(), true));
    EXPECT_EQ(alone, stirred_heat<T>(tests::odd_cut(cells, 3 * ranks(), 2, ranks()), periodic_rows,
                                     MPI_COMM_WORLD, ranks(), true));
  }
}

TEST(Heat, SingleIsTheSameForEveryCut) {
  is_the_same_for_every_cut<float>();
}
TEST(Heat, DoubleIsTheSameForEveryCut) {
  is_the_same_for_every_cut<double>();
}

}  // namespace
}  // namespace silt::lbm

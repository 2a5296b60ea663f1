// Columns of a block's solid cells, against the rows that they are made from.
#include <gtest/gtest.h>

#include <random>

#include "coupler/mapping/side_columns.hpp"

namespace silt::coupler {
namespace {

using lbm::Int3;

TEST(SideColumns, HaveTheCellsOfTheRows) {
  std::mt19937 random(1);
  for (const Int3 size :
       {Int3{1, 1, 1}, Int3{3, 70, 2}, Int3{4, 60, 5}, Int3{63, 64, 3}, Int3{130, 129, 4}}) {
    SCOPED_TRACE(::testing::Message() << size.x << " x " << size.y << " x " << size.z);
    constexpr int ghosts = CellBits::ghosts;
    const Int3 margin{ghosts, ghosts, ghosts};
    CellBits first(size), solid(size);
    for_cells(Int3{} - margin, size + margin, [&](Int3 x) {
      if (random() % 3 == 0) first.set(x);
      if (random() % 3 == 0) solid.set(x);
    });
    SideColumns columns(first);
    columns.reset(solid);  // nothing of before stays
    for_cells(Int3{} - margin, size + margin, [&](Int3 x) {
      const std::uint64_t column = columns.from(solid, x.x, x.y, x.z);
      for (int n = 0; n < 64 && x.y + n < size.y + ghosts; ++n)
        ASSERT_EQ(column >> n & 1, std::uint64_t(solid.test(x + Int3{0, n, 0})))
            << x.x << ' ' << x.y << ' ' << n;
    });
  }
}

}  // namespace
}  // namespace silt::coupler

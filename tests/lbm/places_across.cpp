// The places of pairs across: a place for each cell and direction, of no other.
#include "lbm/pairs_across.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "lbm/block.hpp"

namespace silt::lbm {
namespace {

TEST(PlacesAcross, AreOfOneCellAndDirection) {
  for (const Int3 n : {Int3{7, 5, 6}, Int3{1, 4, 3}, Int3{2, 2, 2}, Int3{1, 1, 1}, Int3{9, 1, 2}}) {
    SCOPED_TRACE(testing::Message() << n.x << " x " << n.y << " x " << n.z << " cells");
    const PlacesAcross place(n);
    const CellBox block{{}, n};
    std::vector<int> taken(place.count(), 0);
    std::size_t links = 0;
    for (int i = 1; i < directions; ++i)
      for (int z = 0; z < n.z; ++z)
        for (int y = 0; y < n.y; ++y)
          for (int x = 0; x < n.x; ++x) {
            if (block.contains(Int3{x, y, z} - c[i])) continue;
            const std::uint32_t at = place({x, y, z}, i);
            ASSERT_LT(at, place.count());
            EXPECT_EQ(taken[at]++, 0) << x << ", " << y << ", " << z << " along " << i;
            ++links;
          }
    EXPECT_EQ(place.count() - links, std::size_t(4 * (n.x + n.y + n.z)));  // edges, counted twice
  }
}

}  // namespace
}  // namespace silt::lbm

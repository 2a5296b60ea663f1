// The order of the dense pass: every row once, and what is said to be ready is.
#include "lbm/pass_order.hpp"

#include <gtest/gtest.h>

namespace silt::lbm {
namespace {

/// Counts, for every row, the calls that collide it; -2: not yet.
struct Rows {
  Int3 size;
  std::vector<int> part;  // that did it; -1: the shell
  explicit Rows(Int3 n) : size(n), part(std::size_t(n.y) * n.z, -2) {}
  int& at(int y, int z) { return part[std::size_t(z) * size.y + y]; }
  void collide(const RowRange& rows, int by) {
    for (int z = rows.z0; z < rows.z1; ++z)
      for (int y = rows.y0; y < rows.y1; ++y) {
        EXPECT_EQ(at(y, z), -2) << "row " << y << ", " << z << " collides twice";
        at(y, z) = by;
      }
  }
};

/// Cells are ready when all up to `reach` away have collided.
void expect_ready(const PassOrder& order, Rows& rows, int reach) {
  const Int3 n = rows.size;
  for (int z = reach; z < n.z - reach; ++z)
    for (int y = reach; y < n.y - reach; ++y) {
      int last = -2;
      for (int k = -reach; k <= reach; ++k)
        for (int j = -reach; j <= reach; ++j) last = std::max(last, rows.at(y + j, z + k));
      EXPECT_EQ(order.ready(y, z, reach), last) << y << ", " << z;
      EXPECT_GT(order.next_row(y, reach), y);
      if (y + 1 < order.next_row(y, reach) && y + 1 < n.y - reach) {
        EXPECT_EQ(order.ready(y, z, reach), order.ready(y + 1, z, reach));
      }
    }
}

void expect_order(const PassOrder& order, Int3 n) {
  Rows rows(n);
  for (const RowRange& range : order.shell()) rows.collide(range, -1);
  for (int part = 0; part < order.parts(); ++part) rows.collide(order.rows_of(part), part);
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y) {
      EXPECT_EQ(rows.at(y, z), order.part_of(y, z)) << y << ", " << z;
      EXPECT_EQ(rows.at(y, z) == -1, order.in_shell(y, z));
    }
  for (int reach = 1; reach <= 2; ++reach) expect_ready(order, rows, reach);
}

TEST(PassOrder, CollidesEveryRowOnceAndKnowsWhatIsReady) {
  for (const Int3 n :
       {Int3{64, 7, 5}, Int3{700, 30, 6}, Int3{2000, 26, 4}, Int3{16, 2, 2}, Int3{16, 1, 1}, Int3{16, 5, 1}})
    for (int faces = 0; faces < 16; ++faces) {
      SCOPED_TRACE(testing::Message() << n.y << " x " << n.z << " rows, faces " << faces);
      const ShellFaces shell{{bool(faces & 1), bool(faces & 2)}, {bool(faces & 4), bool(faces & 8)}};
      expect_order(PassOrder(n, 8, shell), n);
    }
}

}  // namespace
}  // namespace silt::lbm

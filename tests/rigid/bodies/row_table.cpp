// A table of ids against a plain search.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "rigid/bodies/body_set.hpp"

namespace silt::rigid {
namespace {

constexpr std::size_t none = ~std::size_t{0};

std::size_t searched(const std::vector<BodyId>& ids, BodyId id) {
  const auto at = std::find(ids.begin(), ids.end(), id);
  return at == ids.end() ? none : std::size_t(at - ids.begin());
}

TEST(RowTable, FindsWhatASearchFinds) {
  std::mt19937_64 g(3);
  RowTable table;
  EXPECT_EQ(table.find(0, none), none) << "before anything was assigned";
  for (const int count : {0, 1, 2, 3, 64, 65, 1000}) {
    std::vector<BodyId> ids(count);
    for (BodyId& id : ids) id = g() % 2 ? g() % (2 * count) : g() % 100;  // some twice
    for (std::size_t k = 0; k < ids.size(); k += 3) ids[k] = ~ids[k];     // huge, as those of walls
    table.assign(ids);
    for (const BodyId id : ids) EXPECT_EQ(table.find(id, none), searched(ids, id));
    for (BodyId id = 0; id < BodyId(3 * count + 3); ++id) EXPECT_EQ(table.find(id, none), searched(ids, id));
  }
}

}  // namespace
}  // namespace silt::rigid

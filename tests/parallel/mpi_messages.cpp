#include "parallel/messages.hpp"

#include <gtest/gtest.h>

#include "tests/world.hpp"

namespace silt::parallel::testing {
namespace {

using tests::rank;
using tests::ranks;

/// What rank `from` tells rank `to` in a round: so many numbers, that say who they are from.
std::size_t length_of(int from, int to, int round) {
  const bool long_one = from == 0 && to == ranks() - 1 && round == 1;
  return long_one ? 400'000 : std::size_t((from + 2 * to + round) % 3);
}
bool speaks(int from, int to, int round) {
  return (from + to + round) % 2 == 0;
}

/// Nobody knows who writes to it: in each round some ranks write to some, themselves among them, one message
/// longer than a piece, some empty; what comes is what was sent, by the ranks it is from.
TEST(Messages, UnannouncedOnesComeWholeAndInTheOrderOfRanks) {
  Messages messages(MPI_COMM_WORLD);
  for (int round = 0; round < 3; ++round) {
    for (int to = ranks() - 1; to >= 0; --to)
      if (speaks(rank(), to, round))
        for (std::size_t n = length_of(rank(), to, round), k = (messages.to(to), 0); k < n; ++k)
          put(messages.to(to), std::array<double, 1>{double(rank()) + 1e-6 * double(k)});
    messages.unannounced();
    auto next = messages.received().begin();
    for (int from = 0; from < ranks(); ++from) {
      if (!speaks(from, rank(), round)) continue;
      ASSERT_NE(next, messages.received().end()) << round;
      EXPECT_EQ(next->rank, from);
      ASSERT_EQ(next->bytes.size(), length_of(from, rank(), round) * sizeof(double));
      ByteReader reader(next->bytes);
      for (std::size_t k = 0; !reader.done(); ++k)
        ASSERT_EQ(reader.take<double>(), double(from) + 1e-6 * double(k));
      ++next;
    }
    EXPECT_EQ(next, messages.received().end()) << round;
  }
}

TEST(Messages, PartnersHearOneAnother) {
  Messages messages(MPI_COMM_WORLD);
  std::vector<int> others;
  for (int r = 0; r < ranks(); ++r)
    if (r != rank()) others.push_back(r);
  for (const int to : others)
    if (messages.to(to); to > rank()) put(messages.to(to), rank());
  messages.with_partners(others);
  ASSERT_EQ(messages.received().size(), others.size());
  for (std::size_t k = 0; k < others.size(); ++k) {
    EXPECT_EQ(messages.received()[k].rank, others[k]);
    EXPECT_EQ(messages.received()[k].bytes.size(), others[k] < rank() ? sizeof(int) : 0);
  }
}

}  // namespace
}  // namespace silt::parallel::testing

// Values scattered over the ranks come to equal slices and back, and in order to rank 0.
#include "adapters/hdf5/slice_exchange.hpp"

#include <cstring>
#include <random>

#include "tests/adapters/hdf5/scratch.hpp"

namespace silt::tests {
namespace {

using adapters::hdf5::SliceExchange;
using Run = SliceExchange::Run;

/// Cuts [0, n) into runs of odd lengths, deals them to the ranks at random, and leaves every fifth to nobody.
std::vector<Run> dealt(std::uint64_t n) {
  std::mt19937 random(n);
  std::vector<Run> mine;
  for (std::uint64_t first = 0, k = 0; first < n; ++k) {
    const std::uint64_t length = std::min<std::uint64_t>(1 + random() % 9, n - first);
    if (k % 5 && int(random() % ranks()) == rank()) mine.push_back({first, length});
    first += length;
  }
  return mine;
}

std::uint32_t value(std::uint64_t place) {
  return static_cast<std::uint32_t>(3 * place + 1);
}

std::vector<std::byte> values_of(const std::vector<Run>& runs) {
  std::vector<std::byte> values;
  for (const Run& run : runs)
    for (std::uint64_t k = 0; k < run.length; ++k) parallel::put(values, value(run.first + k));
  return values;
}

/// The whole array with what all ranks have.
std::vector<std::byte> whole_array(std::uint64_t n, const std::vector<Run>& runs) {
  std::vector<std::uint32_t> all(n, 0);
  for (const Run& run : runs)
    for (std::uint64_t k = 0; k < run.length; ++k) all[run.first + k] = value(run.first + k);
  MPI_Allreduce(MPI_IN_PLACE, all.data(), int(n), MPI_UINT32_T, MPI_SUM, MPI_COMM_WORLD);
  std::vector<std::byte> bytes(4 * n);
  if (n > 0) std::memcpy(bytes.data(), all.data(), bytes.size());
  return bytes;
}

TEST(SliceExchange, takes_values_to_slices_and_back) {
  for (const auto& [n, grain] :
       {std::pair<std::uint64_t, std::uint64_t>{0, 1}, {1, 1}, {5, 1}, {6, 3}, {1000, 1}, {1001, 7}}) {
    const auto runs = dealt(n);
    const SliceExchange slices(MPI_COMM_WORLD, n, runs, grain);
    const auto all = whole_array(n, runs), values = values_of(runs), slice = slices.to_slice(4, values);
    ASSERT_EQ(slice.size(), 4 * slices.slice_size());
    EXPECT_EQ(slices.slice_begin() % grain, 0u);
    EXPECT_LE(slices.slice_size(), n / ranks() + grain);
    EXPECT_TRUE(std::equal(slice.begin(), slice.end(), all.begin() + 4 * slices.slice_begin())) << n;
    EXPECT_EQ(sum_over_ranks(double(slices.slice_size())), double(n));
    EXPECT_TRUE(slices.from_slice(4, slice) == values) << n;
    for (const std::size_t piece : {4, 12, 20000}) {
      std::vector<std::byte> handed;
      adapters::hdf5::hand_to_rank_0(slices.comm(), slice, piece, [&](std::span<const std::byte> more) {
        EXPECT_LE(more.size(), piece);
        handed.insert(handed.end(), more.begin(), more.end());
      });
      EXPECT_TRUE(rank() > 0 ? handed.empty() : handed == all) << n;
    }
  }
}

TEST(SliceExchange, readers_may_want_the_same) {
  const SliceExchange slices(MPI_COMM_WORLD, 100, {{10, 80}});
  std::vector<std::byte> slice;
  for (std::uint64_t k = 0; k < slices.slice_size(); ++k)
    parallel::put(slice, value(slices.slice_begin() + k));
  EXPECT_TRUE(slices.from_slice(4, slice) == values_of({{10, 80}}));
}

TEST(SliceExchange, an_error_of_rank_0_leaves_nobody_waiting) {
  const SliceExchange slices(MPI_COMM_WORLD, 1000, {});
  const auto slice = slices.to_slice(8, {});
  EXPECT_TEXT(error_of([&] {
                adapters::hdf5::hand_to_rank_0(slices.comm(), slice, 80,
                                               [](auto) { throw std::runtime_error("no room"); });
              }),
              "no room");
}

TEST(SliceExchange, slices_of_1e16_elements) {
  const std::uint64_t planes = 1'000'000'000'000, plane = 10'000;
  const SliceExchange slices(MPI_COMM_WORLD, planes * plane, {{planes * plane - 1, 1}}, plane);
  EXPECT_EQ(slices.slice_begin(), planes * rank() / ranks() * plane);
  EXPECT_EQ(slices.slice_begin() + slices.slice_size(), planes * (rank() + 1) / ranks() * plane);
}

/// With ids at both ends of a range of 2^40.
TEST(OrderById, of_ids_far_apart) {
  const std::uint64_t n = std::uint64_t{1} << 40;
  const auto order = adapters::hdf5::order_by_id(
      MPI_COMM_WORLD, std::vector<std::uint64_t>{n - 1 - rank(), std::uint64_t(rank())});
  ASSERT_EQ(order.total, std::uint64_t(2 * ranks()));
  EXPECT_FALSE(order.twice);
  ASSERT_EQ(order.rows, (std::vector<std::size_t>{1, 0}));
  EXPECT_EQ(order.places.front().first, std::uint64_t(rank()));
  const SliceExchange::Run last = order.places.back();
  EXPECT_EQ(last.first + last.length, std::uint64_t(2 * ranks() - rank()));
}

}  // namespace
}  // namespace silt::tests

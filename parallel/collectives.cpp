#include "parallel/collectives.hpp"

#include <algorithm>
#include <numeric>

#include "parallel/counted.hpp"

namespace silt::parallel {

using counting::blocking_collective;

namespace {

void reduce(MPI_Comm comm, void* values, std::size_t n, MPI_Datatype type, MPI_Op op) {
  blocking_collective(comm, [&] { MPI_Allreduce(MPI_IN_PLACE, values, int(n), type, op, comm); });
}

}  // namespace

WideSum::WideSum(__int128 sum) {
  for (int k = 0; k < 4; ++k) parts_[k] = std::uint32_t(static_cast<unsigned __int128>(sum) >> (32 * k));
}

__int128 WideSum::value() const {
  unsigned __int128 sum = 0;
  for (int k = 0; k < 4; ++k) sum += static_cast<unsigned __int128>(parts_[k]) << (32 * k);
  return static_cast<__int128>(sum);
}

void sum_words(MPI_Comm comm, std::span<std::int64_t> words) {
  reduce(comm, words.data(), words.size(), MPI_INT64_T, MPI_SUM);
}

void sum_words_before(MPI_Comm comm, std::span<std::int64_t> words) {
  const std::vector<std::int64_t> mine(words.begin(), words.end());
  std::fill(words.begin(), words.end(), 0);  // the result on the first rank, which MPI leaves undefined
  blocking_collective(
      comm, [&] { MPI_Exscan(mine.data(), words.data(), int(words.size()), MPI_INT64_T, MPI_SUM, comm); });
}

double sum_of_doubles(MPI_Comm comm, double sum) {
  reduce(comm, &sum, 1, MPI_DOUBLE, MPI_SUM);
  return sum;
}

void sum_over_ranks(MPI_Comm comm, std::span<__int128> sums) {
  std::vector<WideSum> wide(sums.begin(), sums.end());
  sum_over_ranks(comm, std::span(wide));
  std::transform(wide.begin(), wide.end(), sums.begin(), [](const WideSum& s) { return s.value(); });
}

void max_over_ranks(MPI_Comm comm, std::span<double> values) {
  reduce(comm, values.data(), values.size(), MPI_DOUBLE, MPI_MAX);
}

std::uint64_t least_over_ranks(MPI_Comm comm, std::uint64_t x) {
  reduce(comm, &x, 1, MPI_UINT64_T, MPI_MIN);
  return x;
}

std::uint64_t most_over_ranks(MPI_Comm comm, std::uint64_t x) {
  reduce(comm, &x, 1, MPI_UINT64_T, MPI_MAX);
  return x;
}

void broadcast_bytes(MPI_Comm comm, std::span<std::byte> bytes, int from) {
  constexpr std::size_t piece = 1 << 30;  // MPI counts in int
  do {
    const std::span<std::byte> next = bytes.first(std::min(piece, bytes.size()));
    blocking_collective(comm, [&] { MPI_Bcast(next.data(), int(next.size()), MPI_BYTE, from, comm); });
    bytes = bytes.subspan(next.size());
  } while (!bytes.empty());
}

void broadcast(MPI_Comm comm, std::string& text, int from) {
  std::uint64_t size = text.size();
  broadcast(comm, size, from);
  text.resize(size);
  broadcast(comm, std::span(text.data(), size), from);
}

std::vector<std::size_t> gather_bytes(MPI_Comm comm, std::span<const std::byte> mine, GatherTo to,
                                      std::vector<std::byte>& all) {
  const bool listens = to == GatherTo::all_ranks || rank_of(comm) == 0;
  const int size = int(mine.size());
  std::vector<int> sizes(listens ? ranks_of(comm) : 0), begins(sizes.size());
  blocking_collective(comm, [&] {
    to == GatherTo::all_ranks ? MPI_Allgather(&size, 1, MPI_INT, sizes.data(), 1, MPI_INT, comm)
                              : MPI_Gather(&size, 1, MPI_INT, sizes.data(), 1, MPI_INT, 0, comm);
  });
  std::exclusive_scan(sizes.begin(), sizes.end(), begins.begin(), 0);
  all.resize(listens ? begins.back() + sizes.back() : 0);
  blocking_collective(comm, [&] {
    to == GatherTo::all_ranks
        ? MPI_Allgatherv(mine.data(), size, MPI_BYTE, all.data(), sizes.data(), begins.data(), MPI_BYTE, comm)
        : MPI_Gatherv(mine.data(), size, MPI_BYTE, all.data(), sizes.data(), begins.data(), MPI_BYTE, 0,
                      comm);
  });
  std::vector<std::size_t> first(begins.begin(), begins.end());
  if (listens) first.push_back(all.size());
  return first;
}

}  // namespace silt::parallel

#pragma once
// Blocking collective operations: sums, extremes, broadcasts and gathers. Sums are of integers, so that they
// do not depend on the number of ranks or on the order.
#include <mpi.h>

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace silt::parallel {

/// A sum of 128 bits in parts of 32 bits, lowest first, that are added independently: there is room for the
/// carries of 2^32 ranks (2^31 as signed numbers).
class WideSum {
 public:
  WideSum(__int128 sum = 0);
  __int128 value() const;

 private:
  std::array<std::uint64_t, 4> parts_;
};

/// A record of sums: an integer of 64 bits, a WideSum, or a struct of such members only.
template <class T>
concept Summable = std::is_trivially_copyable_v<T> && alignof(T) == alignof(std::int64_t) &&
                   sizeof(T) % sizeof(std::int64_t) == 0 && (std::is_integral_v<T> || std::is_class_v<T>);

/// Returns the integers of which sums consist; normalises sums that are kept in digits.
template <Summable T, std::size_t n>
std::span<std::int64_t> words_of(std::span<T, n> sums) {
  if constexpr (requires(T & sum) { sum.carry(); })
    for (T& sum : sums) sum.carry();
  return {reinterpret_cast<std::int64_t*>(sums.data()), sums.size_bytes() / sizeof(std::int64_t)};
}
template <Summable T>
std::span<std::int64_t> words_of(T& sum) {
  return words_of(std::span(&sum, 1));
}
template <Summable T>
std::span<std::int64_t> words_of(std::vector<T>& sums) {
  return words_of(std::span(sums));
}

void sum_words(MPI_Comm, std::span<std::int64_t>);
void sum_words_before(MPI_Comm, std::span<std::int64_t>);
double sum_of_doubles(MPI_Comm, double);

/// Return the sum over all ranks, or sum in place.
template <Summable T>
requires(!std::ranges::range<T>) T sum_over_ranks(MPI_Comm comm, T mine) {
  sum_words(comm, words_of(mine));
  return mine;
}
template <std::same_as<double> T>
T sum_over_ranks(MPI_Comm comm, T mine) {  // rounding depends on the ranks
  return sum_of_doubles(comm, mine);
}
template <Summable T, std::size_t n>
void sum_over_ranks(MPI_Comm comm, std::span<T, n> sums) {
  sum_words(comm, words_of(sums));
}
void sum_over_ranks(MPI_Comm, std::span<__int128>);
/// For a record of integers of 128 bits only.
template <class Record>
requires(std::is_class_v<Record> && alignof(Record) == alignof(__int128)) Record
    sum_over_ranks(MPI_Comm comm, Record mine) {
  static_assert(std::is_trivially_copyable_v<Record>);
  sum_over_ranks(comm, std::span(reinterpret_cast<__int128*>(&mine), sizeof mine / sizeof(__int128)));
  return mine;
}
/// Returns the sum over the ranks before this one.
template <Summable T>
T sum_of_ranks_before(MPI_Comm comm, T mine) {
  sum_words_before(comm, words_of(mine));
  return mine;
}

void max_over_ranks(MPI_Comm, std::span<double>);
/// Returns the maximum over all ranks of a number, or of each member of a record of doubles. (An array is
/// passed as a span, not as a pointer.)
template <class T>
requires(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T> && alignof(T) == alignof(double)) T
    max_over_ranks(MPI_Comm comm, T mine) {
  max_over_ranks(comm, std::span(reinterpret_cast<double*>(&mine), sizeof mine / sizeof(double)));
  return mine;
}
std::uint64_t least_over_ranks(MPI_Comm, std::uint64_t);
std::uint64_t most_over_ranks(MPI_Comm, std::uint64_t);

/// Send the values of rank `from` to all ranks.
void broadcast_bytes(MPI_Comm, std::span<std::byte>, int from);
template <class T>
requires std::is_trivially_copyable_v<T>
void broadcast(MPI_Comm comm, std::span<T> values, int from = 0) {
  broadcast_bytes(comm, std::as_writable_bytes(values), from);
}
template <class T>
requires std::is_trivially_copyable_v<T>
void broadcast(MPI_Comm comm, T& value, int from = 0) {
  broadcast(comm, std::span(&value, 1), from);
}
void broadcast(MPI_Comm, std::string&, int from = 0);

/// The ranks that receive gathered values.
enum class GatherTo { all_ranks, root };
/// Returns where the bytes of each rank begin in `all`, and their end; nothing on ranks that do not receive.
std::vector<std::size_t> gather_bytes(MPI_Comm, std::span<const std::byte> mine, GatherTo,
                                      std::vector<std::byte>& all);
/// Returns the values of all ranks in rank order; those of rank r begin at (*first)[r].
template <class T>
requires std::is_trivially_copyable_v<T> std::vector<T> gathered(MPI_Comm comm, std::span<const T> mine,
                                                                 GatherTo to,
                                                                 std::vector<std::size_t>* first = nullptr) {
  std::vector<std::byte> bytes;
  std::vector<std::size_t> begins = gather_bytes(comm, std::as_bytes(mine), to, bytes);
  for (std::size_t& begin : begins) begin /= sizeof(T);
  std::vector<T> all(bytes.size() / sizeof(T));
  if (!all.empty()) std::memcpy(all.data(), bytes.data(), bytes.size());
  if (first) *first = std::move(begins);
  return all;
}

}  // namespace silt::parallel

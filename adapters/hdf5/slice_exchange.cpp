#include "adapters/hdf5/slice_exchange.hpp"

#include <algorithm>
#include <cstring>
#include <exception>
#include <limits>
#include <stdexcept>

#include "adapters/hdf5/together.hpp"

namespace silt::adapters::hdf5 {

namespace {
constexpr int values_tag = 2;  // SparseMessages has 0 and 1
}

int SliceExchange::slice_of(std::uint64_t element) const {
  return static_cast<int>(((element / grain_ + 1) * ranks_ - 1) / groups_);
}

std::uint64_t SliceExchange::begin_of(int rank) const {
  return groups_ * static_cast<std::uint64_t>(rank) / ranks_ * grain_;
}

SliceExchange::SliceExchange(MPI_Comm comm, std::uint64_t elements, const std::vector<Run>& runs,
                             std::uint64_t grain)
    : messages_(comm), groups_(elements / grain), grain_(grain) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks_);
  begin_ = begin_of(rank);
  size_ = begin_of(rank + 1) - begin_;
  std::vector<SparseMessages::Message> asked;
  together(comm, [&] { asked = split(runs); });
  const auto received = messages_.swap(asked);
  together(comm, [&] {
    add_pieces(received);
    for (const auto* partners : {&slices_, &holders_})
      for (const Partner& p : *partners)
        if (p.count > std::size_t{std::numeric_limits<int>::max()})
          throw std::length_error("two ranks share " + std::to_string(p.count) +
                                  " values of an array: use more ranks");
  });
}

/// Tells each rank which parts of the runs lie in its slice.
std::vector<SparseMessages::Message> SliceExchange::split(const std::vector<Run>& runs) {
  std::vector<SparseMessages::Message> asked;
  std::size_t n = 0;
  for (Run run : runs)
    while (run.length > 0) {
      const int to = slice_of(run.first);
      const std::uint64_t here = std::min(run.length, begin_of(to + 1) - run.first);
      if (asked.empty() || asked.back().rank != to) {
        asked.push_back({to, {}});
        slices_.push_back({to, n, 0});
      }
      put(asked.back().bytes, Run{run.first, here});
      slices_.back().count += here;
      n += here;
      run = {run.first + here, run.length - here};
    }
  return asked;
}

void SliceExchange::add_pieces(const std::vector<SparseMessages::Message>& received) {
  std::size_t n = 0;
  for (const auto& m : received) {
    holders_.push_back({m.rank, n, 0});
    for (std::size_t at = 0; at < m.bytes.size(); at += sizeof(Run)) {
      Run run;
      std::memcpy(&run, m.bytes.data() + at, sizeof run);
      pieces_.push_back({run.first - begin_, run.length});
      holders_.back().count += run.length;
    }
    n += holders_.back().count;
  }
}

std::vector<std::byte> SliceExchange::swap(std::size_t element, const std::vector<Partner>& from,
                                           const std::vector<Partner>& to,
                                           const std::vector<std::byte>& values) const {
  std::vector<std::byte> swapped;
  std::vector<MPI_Request> requests;
  together(messages_.comm(), [&] {
    swapped.resize(to.empty() ? 0 : (to.back().first + to.back().count) * element);
    requests.reserve(from.size() + to.size());
  });
  MPI_Datatype type;
  MPI_Type_contiguous(static_cast<int>(element), MPI_BYTE, &type);
  MPI_Type_commit(&type);
  for (const Partner& p : to)
    MPI_Irecv(swapped.data() + p.first * element, static_cast<int>(p.count), type, p.rank, values_tag,
              messages_.comm(), &requests.emplace_back());
  for (const Partner& p : from)
    MPI_Isend(values.data() + p.first * element, static_cast<int>(p.count), type, p.rank, values_tag,
              messages_.comm(), &requests.emplace_back());
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  MPI_Type_free(&type);
  return swapped;
}

/// Whether what this rank has is its slice, and no other rank has a part in either.
bool SliceExchange::is_alone() const {
  return ranks_ == 1 && pieces_.size() == 1 && pieces_[0].first == 0 && pieces_[0].length == size_;
}

std::vector<std::byte> SliceExchange::to_slice(std::size_t element, std::vector<std::byte> values) const {
  if (is_alone()) return values;
  const auto arrived = swap(element, slices_, holders_, values);
  std::vector<std::byte>().swap(values);  // the memory goes to the slice
  std::vector<std::byte> slice;
  together(messages_.comm(), [&] { slice.resize(size_ * element); });
  const std::byte* in = arrived.data();
  for (const Run& p : pieces_) {
    std::memcpy(slice.data() + p.first * element, in, p.length * element);
    in += p.length * element;
  }
  return slice;
}

std::vector<std::byte> SliceExchange::from_slice(std::size_t element,
                                                 const std::vector<std::byte>& slice) const {
  std::vector<std::byte> leaving;
  together(messages_.comm(), [&] {
    leaving.reserve(holders_.empty() ? 0 : (holders_.back().first + holders_.back().count) * element);
  });
  for (const Run& p : pieces_) {
    const std::byte* from = slice.data() + p.first * element;
    leaving.insert(leaving.end(), from, from + p.length * element);
  }
  return swap(element, holders_, slices_, leaving);
}

void SliceExchange::hand_to_rank_0(std::size_t element, const std::vector<std::byte>& slice, const Take& take,
                                   std::uint64_t piece) const {
  int rank = 0;
  MPI_Comm_rank(messages_.comm(), &rank);
  std::exception_ptr failed;
  std::vector<std::byte> values;
  together(messages_.comm(), [&] { values.reserve(std::min(piece, groups_ * grain_) * element); });
  for (int from = rank; from < (rank == 0 ? ranks_ : rank + 1); ++from) {
    const std::uint64_t begin = begin_of(from), end = begin_of(from + 1);
    for (std::uint64_t first = begin; first < end; first += piece) {
      const std::uint64_t n = std::min(piece, end - first);
      const auto* own = slice.data() + (first - begin) * element;
      const int bytes = static_cast<int>(n * element);
      if (rank > 0) {
        MPI_Send(own, bytes, MPI_BYTE, 0, values_tag, messages_.comm());
        continue;
      }
      if (from == 0)
        values.assign(own, own + bytes);
      else
        values.resize(bytes),
            MPI_Recv(values.data(), bytes, MPI_BYTE, from, values_tag, messages_.comm(), MPI_STATUS_IGNORE);
      if (failed) continue;  // the others are still sending
      try {
        take(first, n, values);
      } catch (...) {
        failed = std::current_exception();
      }
    }
  }
  together(messages_.comm(), [&] {
    if (failed) std::rethrow_exception(failed);
  });
}

}  // namespace silt::adapters::hdf5

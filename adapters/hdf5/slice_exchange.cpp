#include "adapters/hdf5/slice_exchange.hpp"

#include <algorithm>
#include <cstring>
#include <exception>
#include <limits>
#include <stdexcept>

#include "parallel/together.hpp"
#include "parallel/transfers.hpp"

namespace silt::adapters::hdf5 {

namespace {
constexpr int values_tag = 0;
}

int SliceExchange::slice_of(std::uint64_t element) const {
  return static_cast<int>(((element / grain_ + 1) * ranks_ - 1) / groups_);
}

std::uint64_t SliceExchange::begin_of(int rank) const {
  return groups_ * static_cast<std::uint64_t>(rank) / ranks_ * grain_;
}

SliceExchange::SliceExchange(MPI_Comm comm, std::uint64_t elements, const std::vector<Run>& runs,
                             std::uint64_t grain)
    : comm_(comm), ranks_(parallel::ranks_of(comm)), groups_(elements / grain), grain_(grain) {
  const int rank = parallel::rank_of(comm);
  begin_ = begin_of(rank);
  size_ = begin_of(rank + 1) - begin_;
  parallel::Messages messages(comm);
  parallel::together(comm, [&] {
    split(runs, messages);
    messages.make_room();
  });
  parallel::together(comm, [&] {
    messages.unannounced();
    add_pieces(messages);
    for (const auto* partners : {&slices_, &holders_})
      for (const Partner& p : *partners)
        if (p.count > std::size_t{std::numeric_limits<int>::max()})
          throw std::length_error("two ranks share " + std::to_string(p.count) +
                                  " values of an array: use more ranks");
  });
}

/// Tells each rank which parts of the runs lie in its slice.
void SliceExchange::split(const std::vector<Run>& runs, parallel::Messages& asked) {
  std::size_t n = 0;
  for (Run run : runs)
    while (run.length > 0) {
      const int to = slice_of(run.first);
      const std::uint64_t here = std::min(run.length, begin_of(to + 1) - run.first);
      if (slices_.empty() || slices_.back().rank != to) slices_.push_back({to, n, 0});
      parallel::put(asked.to(to), Run{run.first, here});
      slices_.back().count += here;
      n += here;
      run = {run.first + here, run.length - here};
    }
}

void SliceExchange::add_pieces(const parallel::Messages& messages) {
  std::size_t n = 0;
  for (const auto& m : messages.received()) {
    holders_.push_back({m.rank, n, 0});
    for (parallel::ByteReader reader(m.bytes); !reader.done();) {
      const Run run = reader.take<Run>();
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
  parallel::Transfers transfers(comm_, values_tag);
  parallel::together(comm_, [&] {
    swapped.resize(to.empty() ? 0 : (to.back().first + to.back().count) * element);
    transfers.reserve(from.size() + to.size());
  });
  for (const Partner& p : to) transfers.receive(p.rank, swapped.data() + p.first * element, p.count, element);
  for (const Partner& p : from) transfers.send(p.rank, values.data() + p.first * element, p.count, element);
  transfers.wait();
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
  parallel::together(comm_, [&] { slice.resize(size_ * element); });
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
  parallel::together(comm_, [&] {
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
  const int rank = parallel::rank_of(comm_);
  std::exception_ptr failed;
  std::vector<std::byte> values;
  parallel::Transfers transfers(comm_, values_tag);
  parallel::together(comm_, [&] {
    values.reserve(std::min(piece, groups_ * grain_) * element);
    transfers.reserve(1);
  });
  for (int from = rank; from < (rank == 0 ? ranks_ : rank + 1); ++from) {
    const std::uint64_t begin = begin_of(from), end = begin_of(from + 1);
    for (std::uint64_t first = begin; first < end; first += piece) {
      const std::uint64_t n = std::min(piece, end - first);
      const auto* own = slice.data() + (first - begin) * element;
      if (rank > 0) {
        transfers.send(0, own, n, element);
        transfers.wait();
        continue;
      }
      if (from == 0) {
        values.assign(own, own + n * element);
      } else {
        values.resize(n * element);
        transfers.receive(from, values.data(), n, element);
        transfers.wait();
      }
      if (failed) continue;  // the others are still sending
      try {
        take(first, n, values);
      } catch (...) {
        failed = std::current_exception();
      }
    }
  }
  parallel::together(comm_, [&] {
    if (failed) std::rethrow_exception(failed);
  });
}

}  // namespace silt::adapters::hdf5

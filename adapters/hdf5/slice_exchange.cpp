#include "adapters/hdf5/slice_exchange.hpp"

#include <algorithm>
#include <cstring>
#include <exception>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "parallel/collectives.hpp"
#include "parallel/together.hpp"
#include "parallel/transfers.hpp"

namespace silt::adapters::hdf5 {

namespace {
constexpr int values_tag = 0, pieces_tag = 1;
}

int SliceExchange::slice_of(std::uint64_t element) const {
  return int(((element / grain_ + 1) * ranks_ - 1) / groups_);
}

std::uint64_t SliceExchange::begin_of(int rank) const {
  return groups_ * std::uint64_t(rank) / ranks_ * grain_;
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

/// Returns whether this rank's values are its whole slice: no other rank has a part in either.
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

namespace {

/// Calls take(piece) for the pieces that a rank sends, the last of which is empty.
void receive_from(parallel::Transfers& transfers, int rank, std::vector<std::byte>& room,
                  const TakePiece& take) {
  for (std::size_t bytes = 1; bytes > 0;) {
    transfers.receive(rank, std::span(room));
    transfers.wait();
    bytes = transfers.bytes_received(0);
    if (bytes > 0) take(std::span(room).first(bytes));
  }
}

/// piece(k) is the k-th piece here, and empty after the last.
template <class Piece>
void hand_over(MPI_Comm comm, std::size_t longest, const TakePiece& take, Piece&& piece) {
  const bool takes = parallel::rank_of(comm) == 0;
  std::vector<std::byte> room;
  parallel::Transfers transfers(comm, pieces_tag);
  parallel::together(comm, [&] {
    transfers.reserve(1);
    if (takes) room.resize(longest);
  });
  for (std::size_t k = 0; !takes; ++k) {
    const std::span<const std::byte> mine = piece(k);
    transfers.send(0, mine);
    transfers.wait();
    if (mine.empty()) break;
  }
  parallel::together(comm, [&] {
    std::exception_ptr failed;
    const auto attempt = [&](std::span<const std::byte> some) {
      if (failed) return;  // the others are still sending
      try {
        take(some);
      } catch (...) {
        failed = std::current_exception();
      }
    };
    for (std::size_t k = 0; takes && !piece(k).empty(); ++k) attempt(piece(k));
    for (int from = 1; takes && from < parallel::ranks_of(comm); ++from)
      receive_from(transfers, from, room, attempt);
    if (failed) std::rethrow_exception(failed);
  });
}

}  // namespace

void hand_to_rank_0(MPI_Comm comm, const std::vector<std::vector<std::byte>>& pieces, std::size_t longest,
                    const TakePiece& take) {
  hand_over(comm, longest, take, [&](std::size_t k) {
    return k < pieces.size() ? std::span<const std::byte>(pieces[k]) : std::span<const std::byte>();
  });
}

void hand_to_rank_0(MPI_Comm comm, std::span<const std::byte> bytes, std::size_t longest,
                    const TakePiece& take) {
  hand_over(comm, longest, take, [&](std::size_t k) {
    const std::size_t first = std::min(k * longest, bytes.size());
    return bytes.subspan(first, std::min(longest, bytes.size() - first));
  });
}

namespace {

constexpr auto none = std::numeric_limits<std::uint64_t>::max();

struct Asked {
  std::uint64_t id;
  int by;
};

/// The ids that all ranks have of this rank's share of the range, in ascending order.
std::vector<Asked> sorted(const parallel::Messages& messages) {
  std::vector<Asked> asked;
  for (const auto& m : messages.received())
    for (parallel::ByteReader reader(m.bytes); !reader.done();)
      asked.push_back({reader.take<std::uint64_t>(), m.rank});
  std::sort(asked.begin(), asked.end(), [](const Asked& a, const Asked& b) { return a.id < b.id; });
  return asked;
}

std::uint64_t least_twice(const std::vector<Asked>& asked) {
  const auto at = std::adjacent_find(asked.begin(), asked.end(),
                                     [](const Asked& a, const Asked& b) { return a.id == b.id; });
  return at == asked.end() ? none : at->id;
}

}  // namespace

IdOrder order_by_id(MPI_Comm comm, std::span<const std::uint64_t> ids) {
  parallel::Messages messages(comm);
  IdOrder result;
  const auto [min, max] = std::minmax_element(ids.begin(), ids.end());
  const std::uint64_t least = parallel::least_over_ranks(comm, ids.empty() ? none : *min);
  const std::uint64_t greatest = parallel::most_over_ranks(comm, ids.empty() ? 0 : *max);
  result.total = parallel::sum_over_ranks(comm, std::uint64_t(ids.size()));
  if (result.total == 0) return result;

  const int ranks = parallel::ranks_of(comm);
  const auto range = static_cast<unsigned __int128>(greatest - least) + 1;
  parallel::together(comm, [&] {
    result.rows.resize(ids.size());
    std::iota(result.rows.begin(), result.rows.end(), std::size_t{0});
    std::sort(result.rows.begin(), result.rows.end(),
              [&](std::size_t a, std::size_t b) { return ids[a] < ids[b]; });
    for (const std::size_t i : result.rows)
      parallel::put(messages.to(int(static_cast<unsigned __int128>(ids[i] - least) * ranks / range)), ids[i]);
    messages.make_room();
  });
  std::vector<Asked> asked;
  parallel::together(comm, [&] {
    messages.unannounced();
    asked = sorted(messages);
  });
  std::uint64_t number = parallel::sum_of_ranks_before(comm, std::uint64_t(asked.size()));
  const std::uint64_t twice = parallel::least_over_ranks(comm, least_twice(asked));
  if (twice != none) result.twice = twice;
  parallel::together(comm, [&] {  // each rank is answered in the order of the ids it has
    for (const Asked& a : asked) parallel::put(messages.to(a.by), number++);
    messages.make_room();
  });
  parallel::together(comm, [&] {
    messages.unannounced();
    for (const auto& m : messages.received())
      for (parallel::ByteReader reader(m.bytes); !reader.done();)
        append_run(result.places, {reader.take<std::uint64_t>(), 1});
  });
  return result;
}

}  // namespace silt::adapters::hdf5

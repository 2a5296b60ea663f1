#include "adapters/hdf5/slice_exchange.hpp"

#include <algorithm>
#include <cstring>
#include <exception>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "parallel/collectives.hpp"
#include "parallel/messages.hpp"
#include "parallel/together.hpp"

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
    messages.exchange_sparse();
    add_pieces(messages);
    for (const auto* partners : {&slices_, &holders_})
      for (const Partner& p : *partners)
        if (p.count > std::size_t{std::numeric_limits<int>::max()})
          throw std::length_error("two ranks share " + std::to_string(p.count) +
                                  " values of an array: use more ranks");
  });
}

/// Sends to each rank the parts of the runs that lie in its slice.
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
      const Run run = reader.read<Run>();
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

/// Returns whether the runs of this rank are its whole slice, without parts of other ranks.
bool SliceExchange::is_alone() const {
  return ranks_ == 1 && pieces_.size() == 1 && pieces_[0].first == 0 && pieces_[0].length == size_;
}

std::vector<std::byte> SliceExchange::to_slice(std::size_t element, std::vector<std::byte> values) const {
  if (is_alone()) return values;
  const auto arrived = swap(element, slices_, holders_, values);
  std::vector<std::byte>().swap(values);  // releases the memory before the slice is allocated
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

/// Calls take(piece) for the pieces of a rank, up to an empty one.
void receive_from(parallel::Transfers& transfers, int rank, std::vector<std::byte>& room,
                  const UsePiece& take) {
  for (std::size_t bytes = 1; bytes > 0;) {
    transfers.receive(rank, std::span(room));
    transfers.wait();
    bytes = transfers.bytes_received(0);
    if (bytes > 0) take(std::span(room).first(bytes));
  }
}

/// piece(k) is this rank's k-th piece, empty after the last.
template <class Piece>
void send_pieces(MPI_Comm comm, std::size_t longest, const UsePiece& take, Piece&& piece) {
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
      if (failed) return;  // the other ranks are still sending
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

void gather_in_pieces(MPI_Comm comm, const std::vector<std::vector<std::byte>>& pieces, std::size_t longest,
                      const UsePiece& take) {
  send_pieces(comm, longest, take, [&](std::size_t k) {
    return k < pieces.size() ? std::span<const std::byte>(pieces[k]) : std::span<const std::byte>();
  });
}

void gather_in_pieces(MPI_Comm comm, std::span<const std::byte> bytes, std::size_t longest,
                      const UsePiece& take) {
  send_pieces(comm, longest, take, [&](std::size_t k) {
    const std::size_t first = std::min(k * longest, bytes.size());
    return bytes.subspan(first, std::min(longest, bytes.size() - first));
  });
}

namespace {

constexpr auto none = std::numeric_limits<std::uint64_t>::max();

struct IdOnRank {
  std::uint64_t id;
  int by;
};

/// Returns the ids in this rank's share of the range, from all ranks, in ascending order.
std::vector<IdOnRank> sorted(const parallel::Messages& messages) {
  std::vector<IdOnRank> asked;
  for (const auto& m : messages.received())
    for (parallel::ByteReader reader(m.bytes); !reader.done();)
      asked.push_back({reader.read<std::uint64_t>(), m.rank});
  std::sort(asked.begin(), asked.end(), [](const IdOnRank& a, const IdOnRank& b) { return a.id < b.id; });
  return asked;
}

std::uint64_t least_twice(const std::vector<IdOnRank>& asked) {
  const auto at = std::adjacent_find(asked.begin(), asked.end(),
                                     [](const IdOnRank& a, const IdOnRank& b) { return a.id == b.id; });
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
  std::vector<IdOnRank> asked;
  parallel::together(comm, [&] {
    messages.exchange_sparse();
    asked = sorted(messages);
  });
  std::uint64_t number = parallel::sum_of_ranks_before(comm, std::uint64_t(asked.size()));
  const std::uint64_t twice = parallel::least_over_ranks(comm, least_twice(asked));
  if (twice != none) result.twice = twice;
  parallel::together(comm, [&] {  // each rank gets the places in the order of its ids
    for (const IdOnRank& a : asked) parallel::put(messages.to(a.by), number++);
    messages.make_room();
  });
  parallel::together(comm, [&] {
    messages.exchange_sparse();
    for (const auto& m : messages.received())
      for (parallel::ByteReader reader(m.bytes); !reader.done();)
        append_run(result.places, {reader.read<std::uint64_t>(), 1});
  });
  return result;
}

}  // namespace silt::adapters::hdf5

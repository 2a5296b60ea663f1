#include "adapters/hdf5/slice_exchange.hpp"

#include <algorithm>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <tuple>

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
void receive_from(parallel::Transfers& transfers, int rank, std::span<std::byte> room, const UsePiece& take) {
  for (std::size_t bytes = 1; bytes > 0;) {
    transfers.receive(rank, room);
    transfers.wait();
    bytes = transfers.bytes_received(0);
    if (bytes > 0) take(room.first(bytes));
  }
}

/// piece(k) is this rank's k-th piece, empty after the last.
template <class Piece>
void send_pieces(MPI_Comm comm, std::size_t longest, const UsePiece& take, Piece&& piece) {
  const bool takes = parallel::rank_of(comm) == 0;
  std::unique_ptr<std::byte[]> room;  // not cleared: most pieces are far shorter
  parallel::Transfers transfers(comm, pieces_tag);
  parallel::together(comm, [&] {
    transfers.reserve(1);
    if (takes) room = std::make_unique_for_overwrite<std::byte[]>(longest);
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
      receive_from(transfers, from, std::span(room.get(), longest), attempt);
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

SlabExchange::SlabExchange(MPI_Comm comm, std::array<int, 3> cells, std::vector<CellBox> boxes)
    : lattice_(cells), boxes_(std::move(boxes)) {
  std::vector<SliceExchange::Run> mine;
  parallel::together(comm, [&] { mine = list_rows(); });
  const std::uint64_t row = lattice_[0];
  slices_.emplace(comm, row * lattice_[1] * lattice_[2], mine, row);
}

SlabExchange::SlabExchange(MPI_Comm comm, std::vector<CellBox> boxes) : boxes_(std::move(boxes)) {
  for (const CellBox& box : boxes_) cells_ += box.cells();
  const std::uint64_t first = parallel::sum_of_ranks_before(comm, std::uint64_t(cells_)),
                      all = parallel::sum_over_ranks(comm, std::uint64_t(cells_));
  std::vector<SliceExchange::Run> mine;
  if (cells_ > 0) mine.push_back({first, cells_});
  slices_.emplace(comm, all, mine);
}

/// Lists the rows of the boxes in file order; returns their positions in the lattice.
std::vector<SliceExchange::Run> SlabExchange::list_rows() {
  for (std::size_t b = 0; b < boxes_.size(); ++b) {
    const CellBox& box = boxes_[b];
    for (int d = 0; d < 3; ++d)
      if (box.lower[d] < 0 || box.size[d] < 0 || box.lower[d] + box.size[d] > lattice_[d])
        throw std::invalid_argument("box " + std::to_string(b) + " reaches outside the lattice of " +
                                    std::to_string(lattice_[0]) + " x " + std::to_string(lattice_[1]) +
                                    " x " + std::to_string(lattice_[2]) + " cells");
    if (box.cells() == 0) continue;
    const std::size_t length = box.size.x;
    std::size_t offset = 0;
    for_cells(box.lower, box.lower + lbm::Int3{1, box.size.y, box.size.z}, [&](lbm::Int3 first) {
      rows_.push_back({first, length, b, offset});
      offset += length;
    });
    cells_ += box.cells();
  }
  std::sort(rows_.begin(), rows_.end(), [](const Row& a, const Row& b) {
    return std::tie(a.first.z, a.first.y, a.first.x) < std::tie(b.first.z, b.first.y, b.first.x);
  });
  std::vector<SliceExchange::Run> runs;
  for (const Row& row : rows_)
    append_run(runs, {(std::uint64_t(row.first.z) * lattice_[1] + row.first.y) * lattice_[0] + row.first.x,
                      row.length});
  return runs;
}

std::vector<std::byte> SlabExchange::pack(std::size_t element,
                                          const std::function<void(std::size_t, void*)>& fill) const {
  std::vector<std::byte> packed(cells_ * element);
  std::byte* out = packed.data();
  std::vector<std::vector<std::byte>> of_box(boxes_.size());
  const bool in_order = boxes_.size() == 1 || rows_.empty();
  for (std::size_t b = 0; b < boxes_.size(); ++b) {
    const std::size_t bytes = boxes_[b].cells() * element;
    if (bytes == 0) continue;
    if (!in_order) of_box[b].resize(bytes);
    fill(b, in_order ? out : of_box[b].data());
    if (in_order) out += bytes;
  }
  if (in_order) return packed;
  for (const Row& row : rows_) {
    std::memcpy(out, of_box[row.box].data() + row.offset * element, row.length * element);
    out += row.length * element;
  }
  return packed;
}

void SlabExchange::unpack(const std::vector<std::byte>& packed, std::size_t element,
                          const std::function<void(std::size_t, const void*)>& take) const {
  std::vector<std::vector<std::byte>> of_box(boxes_.size());
  for (std::size_t b = 0; b < boxes_.size(); ++b) of_box[b].resize(boxes_[b].cells() * element);
  const std::byte* in = packed.data();
  for (const Row& row : rows_) {
    std::memcpy(of_box[row.box].data() + row.offset * element, in, row.length * element);
    in += row.length * element;
  }
  for (std::size_t b = 0; b < boxes_.size(); ++b)
    if (!of_box[b].empty()) take(b, of_box[b].data());
}

TileRuns runs_of_tiles(MPI_Comm comm, const ListedTiles& tiles) {
  const SlabExchange slabs(comm, tiles.lattice, {tiles.box});
  const auto bytes = std::as_bytes(tiles.counts);
  const auto slab = slabs.slices().to_slice(sizeof(std::uint32_t), {bytes.begin(), bytes.end()});
  std::vector<std::uint32_t> counts_here(slab.size() / sizeof(std::uint32_t));
  std::memcpy(counts_here.data(), slab.data(), slab.size());
  const std::uint64_t sum = std::accumulate(counts_here.begin(), counts_here.end(), std::uint64_t{0});
  TileRuns runs{parallel::sum_over_ranks(comm, sum), {}};
  std::uint64_t first = parallel::sum_of_ranks_before(comm, sum);
  std::vector<std::byte> firsts(counts_here.size() * sizeof first);
  for (std::size_t tile = 0; tile < counts_here.size(); first += counts_here[tile++])
    std::memcpy(&firsts[tile * sizeof first], &first, sizeof first);
  firsts = slabs.slices().from_slice(sizeof first, firsts);
  for (std::size_t tile = 0; tile < tiles.counts.size(); ++tile) {
    std::memcpy(&first, &firsts[tile * sizeof first], sizeof first);
    if (tiles.counts[tile] > 0) append_run(runs.mine, {first, tiles.counts[tile]});
  }
  return runs;
}

}  // namespace silt::adapters::hdf5

#include "lbm/pairs_across.hpp"

#include <algorithm>
#include <map>

#include "lbm/places_across.hpp"
#include "parallel/communicator.hpp"

namespace silt::lbm {

namespace {

/// Calls visit(x, i, axis) for every cell x and direction i of a block with x - c_i outside it, once, with
/// the first axis across which it is: in the order of places, but for those of no cell.
template <class Visit>
void for_pairs_across(Int3 size, Visit&& visit) {
  for (int i = 1; i < directions; ++i) {
    const auto enters = [&](Int3 x, int d) {
      return c[i][d] != 0 && x[d] == (c[i][d] > 0 ? 0 : size[d] - 1);
    };
    for (int axis = 0; axis < 3; ++axis) {
      if (c[i][axis] == 0) continue;
      Int3 lo, hi = size;
      (c[i][axis] > 0 ? hi : lo)[axis] = c[i][axis] > 0 ? 1 : size[axis] - 1;
      for (int z = lo.z; z < hi.z; ++z)
        for (int y = lo.y; y < hi.y; ++y)
          for (int x = lo.x; x < hi.x; ++x) {
            const Int3 cell{x, y, z};
            if (!(axis > 0 && enters(cell, 0)) && !(axis > 1 && enters(cell, 1))) visit(cell, i, axis);
          }
    }
  }
}

}  // namespace

template <class T>
void PairsAcross<T>::Reads::add(int block, int direction, std::uint32_t cell) {
  if (runs.empty() || runs.back().block != block || runs.back().direction != direction)
    runs.push_back({block, direction, 0});
  cells.push_back(cell);
  runs.back().end = std::uint32_t(cells.size());
}

template <class T>
void PairsAcross<T>::Places::add(int block, std::uint32_t place) {
  if (runs.empty() || runs.back().block != block) runs.push_back({block, 0});
  places.push_back(place);
  runs.back().end = std::uint32_t(places.size());
}

template <class T>
struct PairsAcross<T>::Builder {
  PairsAcross& pairs;
  const Domain& domain;
  std::span<const Block<T>> blocks;
  int rank;
  std::map<int, Peer> peers;
  BlockPlace behind_block{-1, {}, -1};  // of the last cell behind: rows stay in one block

  static bool follows(const Line& line, const Line& one) {
    const Int3 next =
        line.first + (one.along_y ? Int3{0, int(line.length), 0} : Int3{int(line.length), 0, 0});
    return line.block == one.block && line.direction == one.direction && line.along_y == one.along_y &&
           next == one.first;
  }
  /// Adds a line of one cell, or that cell to the last line.
  template <class Entry>
  static void add_to(std::vector<Entry>& entries, const Entry& one) {
    if (!entries.empty() && follows(entries.back().line, one.line) && goes_on(entries.back(), one))
      ++entries.back().line.length;
    else
      entries.push_back(one);
  }
  /// The cells behind a line may have a period's end between them.
  static bool goes_on(const Copy& entry, const Copy& one) {
    return entry.from_block == one.from_block &&
           entry.from.first + entry.line.length * entry.from.stride == one.from.first;
  }
  static bool goes_on(const Sent&, const Sent&) { return true; }
  static bool goes_on(const Received&, const Received&) { return true; }

  void add(const BlockPlace& place, const PlacesAcross& places, Int3 x, int i, int axis) {
    const Int3 behind = domain.wrapped(place.box.lower + x - c[i]);
    if (!domain.inside(behind)) return;
    if (!behind_block.box.contains(behind)) behind_block = domain.block_at(behind);
    const int here = domain.local_index(place, rank), there = domain.local_index(behind_block, rank);
    const Int3 cell = behind - behind_block.box.lower;
    const Line line{here, i, x, axis == 0, 1};
    Cells from{};
    if (there >= 0)
      from = {std::uint32_t(blocks[there].cell(cell)),
              std::uint32_t(axis == 0 ? blocks[there].row_stride() : 1)};
    if (here >= 0 && there >= 0)
      add_to(pairs.copies_, {line, there, from, places(x, i)});
    else if (here >= 0)
      add_to(peers[behind_block.rank].received, {line, places(x, i)});
    else if (there >= 0)
      add_to(peers[place.rank].sent, {{there, i, cell + c[i], axis == 0, 1}, from});
  }

  void build() {
    for (const int b : domain.neighbourhood_of_rank(rank)) {
      const BlockPlace place = domain.block(b);
      const PlacesAcross places(place.box.size);
      if (domain.local_index(place, rank) >= 0)
        pairs.pairs_[domain.local_index(place, rank)].resize(places.count());
      for_pairs_across(place.box.size, [&](Int3 x, int i, int axis) { add(place, places, x, i, axis); });
    }
    for (auto& [r, peer] : peers) {
      peer.rank = r;
      pairs.peers_.push_back(std::move(peer));
    }
  }
};

template <class T>
PairsAcross<T>::PairsAcross(const Domain& domain, MPI_Comm comm, std::span<const Block<T>> blocks)
    : pairs_(blocks.size()), transfers_(comm, 3) {
  const int rank = parallel::rank_of(comm);
  Builder builder{*this, domain, blocks, rank, {}};
  builder.build();
  choose_lines([](const Line& line, auto&& visit) {
    for (std::uint32_t n = 0; n < line.length; ++n) visit(n);
  });
}

template <class T>
void PairsAcross<T>::read(std::span<const Block<T>> blocks, const Reads& reads, Parity parity,
                          BeyondPair<T>* to) {
  std::uint32_t n = 0;
  for (const auto& run : reads.runs) {
    const Block<T>& block = blocks[run.block];
    const T* const away = block.data() + block.leaving(opposite(run.direction), parity);
    const T* const toward = block.data() + block.arriving(run.direction, parity);
    for (; n < run.end; ++n) to[n] = {away[reads.cells[n]], toward[reads.cells[n]]};
  }
}

template <class T>
void PairsAcross<T>::fill(const BeyondPair<T>* from, const Places& fills) {
  std::uint32_t n = 0;
  for (const auto& run : fills.runs)
    for (BeyondPair<T>* const to = pairs_[run.block].data(); n < run.end; ++n) to[fills.places[n]] = from[n];
}

template <class T>
void PairsAcross<T>::start_messages(std::span<const Block<T>> blocks, Parity parity) {
  for (Peer& peer : peers_)
    if (!peer.incoming.empty()) transfers_.receive(peer.rank, std::span(peer.incoming));
  for (Peer& peer : peers_) {
    if (peer.outgoing.empty()) continue;
    read(blocks, peer.reads, parity, peer.outgoing.data());
    transfers_.send(peer.rank, std::span(peer.outgoing));
  }
}

template <class T>
void PairsAcross<T>::exchange(std::span<const Block<T>> blocks, Parity parity) {
  start_messages(blocks, parity);
  read(blocks, copied_, parity, copying_.data());
  fill(copying_.data(), copied_to_);
  transfers_.wait();
  for (const Peer& peer : peers_) fill(peer.incoming.data(), peer.fills);
}

template <class T>
std::size_t PairsAcross<T>::message_bytes() const {
  std::size_t n = 0;
  for (const Peer& peer : peers_) n += peer.outgoing.size() * sizeof(BeyondPair<T>);
  return n;
}

template <class T>
std::size_t PairsAcross<T>::bytes() const {
  const auto listed = [](const Reads& reads, const Places& fills) {
    return (reads.cells.size() + fills.places.size()) * sizeof(std::uint32_t);
  };
  std::size_t n =
      copying_.size() * sizeof(BeyondPair<T>) + copies_.size() * sizeof(Copy) + listed(copied_, copied_to_);
  for (const auto& of_block : pairs_) n += of_block.size() * sizeof(BeyondPair<T>);
  for (const Peer& peer : peers_)
    n += (peer.outgoing.size() + peer.incoming.size()) * sizeof(BeyondPair<T>) +
         listed(peer.reads, peer.fills) + peer.sent.size() * sizeof(Sent) +
         peer.received.size() * sizeof(Received);
  return n;
}

template class PairsAcross<float>;
template class PairsAcross<double>;

}  // namespace silt::lbm

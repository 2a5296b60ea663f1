#include "lbm/pairs_across.hpp"

#include <algorithm>
#include <map>
#include <type_traits>

#include "lbm/places_across.hpp"

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
bool PairsAcross<T>::follows(const Cells& run, const Cells& one) {
  return run.block == one.block && run.direction == one.direction && run.stride == one.stride &&
         run.first + run.length * run.stride == one.first;
}

template <class T>
bool PairsAcross<T>::follows(const Places& run, const Places& one) {
  return run.block == one.block && run.first + run.length == one.first;
}

template <class T>
struct PairsAcross<T>::Builder {
  PairsAcross& pairs;
  const Domain& domain;
  std::span<const Block<T>> blocks;
  int rank;
  std::map<int, Peer> peers;
  BlockPlace behind_block{-1, {}, -1};  // of the last cell behind: rows stay in one block

  template <class Run>
  static void add_to(std::vector<Run>& runs, const Run& one) {
    if (!runs.empty() && follows(runs.back(), one))
      ++runs.back().length;
    else
      runs.push_back(one);
  }

  void add_copy(const Cells& from, const Places& to) {
    auto& copies = pairs.copies_;
    if (!copies.empty() && follows(copies.back().from, from) && follows(copies.back().to, to))
      ++copies.back().from.length, ++copies.back().to.length;
    else
      copies.push_back({from, to});
  }

  /// The cells that a block's pairs come from, as a run of one.
  Cells cells_at(int block, Int3 cell, int i, int axis) const {
    const Block<T>& b = blocks[block];
    return {block, i, std::uint32_t(b.cell(cell)), std::uint32_t(axis == 0 ? b.row_stride() : 1), 1};
  }

  void add(const BlockPlace& place, const PlacesAcross& places, Int3 x, int i, int axis) {
    const Int3 behind = domain.wrapped(place.box.lower + x - c[i]);
    if (!domain.inside(behind)) return;
    if (!behind_block.box.contains(behind)) behind_block = domain.block_at(behind);
    const int here = domain.local_index(place, rank), there = domain.local_index(behind_block, rank);
    const Int3 cell = behind - behind_block.box.lower;
    if (here >= 0 && there >= 0)
      add_copy(cells_at(there, cell, i, axis), {here, places(x, i), 1});
    else if (here >= 0)
      add_to(peers[behind_block.rank].received, {here, places(x, i), 1});
    else if (there >= 0)
      add_to(peers[place.rank].sent, cells_at(there, cell, i, axis));
  }

  template <class Run>
  static std::size_t pairs_in(const std::vector<Run>& runs) {
    std::size_t n = 0;
    for (const Run& run : runs) n += run.length;
    return n;
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
      peer.outgoing.resize(pairs_in(peer.sent));
      peer.incoming.resize(pairs_in(peer.received));
      pairs.peers_.push_back(std::move(peer));
    }
  }
};

template <class T>
PairsAcross<T>::PairsAcross(const Domain& domain, MPI_Comm comm, std::span<const Block<T>> blocks)
    : comm_(comm), pairs_(blocks.size()) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  Builder builder{*this, domain, blocks, rank, {}};
  builder.build();
  requests_.resize(2 * peers_.size(), MPI_REQUEST_NULL);
}

template <class T>
void PairsAcross<T>::read(std::span<const Block<T>> blocks, const Cells& run, Parity parity,
                          BeyondPair<T>* to) {
  const Block<T>& block = blocks[run.block];
  const T* away = block.data() + block.leaving(opposite(run.direction), parity) + run.first;
  const T* toward = block.data() + block.arriving(run.direction, parity) + run.first;
  for (std::uint32_t n = 0; n < run.length; ++n, away += run.stride, toward += run.stride)
    to[n] = {*away, *toward};
}

template <class T>
void PairsAcross<T>::start_messages(std::span<const Block<T>> blocks, Parity parity) {
  const MPI_Datatype type = std::is_same_v<T, float> ? MPI_FLOAT : MPI_DOUBLE;
  constexpr int tag = 3;
  for (std::size_t k = 0; k < peers_.size(); ++k)
    MPI_Irecv(peers_[k].incoming.data(), 2 * int(peers_[k].incoming.size()), type, peers_[k].rank, tag, comm_,
              &requests_[k]);
  for (std::size_t k = 0; k < peers_.size(); ++k) {
    Peer& peer = peers_[k];
    BeyondPair<T>* to = peer.outgoing.data();
    for (const Cells& run : peer.sent) {
      read(blocks, run, parity, to);
      to += run.length;
    }
    MPI_Isend(peer.outgoing.data(), 2 * int(peer.outgoing.size()), type, peer.rank, tag, comm_,
              &requests_[peers_.size() + k]);
  }
}

template <class T>
void PairsAcross<T>::exchange(std::span<const Block<T>> blocks, Parity parity, std::span<const char> wanted) {
  const auto is_wanted = [&](int block) { return wanted.empty() || wanted[block]; };
  start_messages(blocks, parity);
  for (const Copy& copy : copies_)
    if (is_wanted(copy.to.block))
      read(blocks, copy.from, parity, pairs_[copy.to.block].data() + copy.to.first);
  MPI_Waitall(int(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE);
  for (const Peer& peer : peers_) {
    const BeyondPair<T>* from = peer.incoming.data();
    for (const Places& run : peer.received) {
      if (is_wanted(run.block)) std::copy_n(from, run.length, pairs_[run.block].data() + run.first);
      from += run.length;
    }
  }
}

template <class T>
std::size_t PairsAcross<T>::message_bytes() const {
  std::size_t n = 0;
  for (const Peer& peer : peers_) n += peer.outgoing.size() * sizeof(BeyondPair<T>);
  return n;
}

template <class T>
std::size_t PairsAcross<T>::bytes() const {
  std::size_t n = 0;
  for (const auto& of_block : pairs_) n += of_block.size() * sizeof(BeyondPair<T>);
  for (const Peer& peer : peers_) n += (peer.outgoing.size() + peer.incoming.size()) * sizeof(BeyondPair<T>);
  return n;
}

template class PairsAcross<float>;
template class PairsAcross<double>;

}  // namespace silt::lbm

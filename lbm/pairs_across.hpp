#pragma once
// A link from x along c_i may read what passes between x - c_i and x - 2 c_i (BeyondPair). Where x - c_i is a
// cell of another block, or of the same one through a period, that block has the pair, in slots of its own or
// of its ghost layer; this brings it. No slot of a pair is overwritten between the halo exchange and the next
// pass: where a ghost slot was returned to its home, it keeps what was sent.
//
// Which pairs are read follows from the solid cells on either side of a face, which both ranks know: nothing
// is asked for, and only these pairs move.
#include <mpi.h>

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "lbm/cut_links.hpp"
#include "lbm/domain.hpp"
#include "parallel/transfers.hpp"

namespace silt::lbm {

/// The pairs of cells x and directions i with x - c_i outside their block, brought from where x - c_i is. A
/// pair whose x - c_i is beyond a side of the domain that is not periodic does not exist; it stays 0.
template <class T>
class PairsAcross {
 public:
  /// `blocks` are the local ones, in the order of domain.blocks_of(rank). All pairs are brought until some
  /// are chosen.
  PairsAcross(const Domain&, MPI_Comm, std::span<const Block<T>> blocks);
  /// From now on the pairs of cut links are brought: of fluid cells x with x + c_i solid; others mean
  /// nothing. solid(block, cell, axis) has 64 cells of a local block along x or y as bits, `cell` the first,
  /// for cells to two beyond its faces. Each rank calls it when one of these of its blocks has changed. What
  /// two ranks know of the same cells must agree: how long their messages are follows from it.
  template <class Solid>
  void choose(Solid&& solid);
  /// Call after the halo exchange, with the parity of the blocks then. The pair of an idle block means
  /// nothing.
  void exchange(std::span<const Block<T>> blocks, Parity);
  /// The pairs of a local block lie in the order of its PlacesAcross.
  const BeyondPair<T>* of(int block) const { return pairs_[block].data(); }
  /// The bytes that this rank sends in one exchange.
  std::size_t message_bytes() const;
  /// The bytes held for pairs and messages.
  std::size_t bytes() const;

 private:
  /// Cells x one after the other, along x or along y, whose links along a direction may read a pair; in a
  /// local block or, as another rank's that reads here, beyond its faces.
  struct Line {
    int block, direction;
    Int3 first;
    bool along_y;
    std::uint32_t length;
  };
  struct Cells {                  // of a local block, where the pairs of a line are read
    std::uint32_t first, stride;  // Block::cell of the first, and from each to the next
  };
  struct Copy {  // between two local blocks
    Line line;   // in the block that reads
    int from_block;
    Cells from;
    std::uint32_t place;  // of the first
  };
  struct Sent {
    Line line;  // beyond the faces of the local block
    Cells from;
  };
  struct Received {
    Line line;
    std::uint32_t place;
  };
  /// Chosen pairs of one line after the other.
  struct Reads {  // along a direction of a block
    struct Run {
      int block, direction;
      std::uint32_t end;  // of `cells`
    };
    std::vector<Run> runs;
    std::vector<std::uint32_t> cells;
    void add(int block, int direction, std::uint32_t cell);
  };
  struct Places {
    struct Run {
      int block;
      std::uint32_t end;  // of `places`
    };
    std::vector<Run> runs;
    std::vector<std::uint32_t> places;
    void add(int block, std::uint32_t place);
  };
  struct Peer {
    int rank;
    std::vector<Sent> sent;
    std::vector<Received> received;
    Reads reads;
    Places fills;
    std::vector<BeyondPair<T>> outgoing, incoming;
  };
  struct Builder;

  /// Calls visit(n) for the cells of a line that have a cut link, the n-th of it.
  template <class Solid, class Visit>
  static void for_cut(const Line&, Solid&& solid, Visit&& visit);
  /// Chooses the pairs of the cells of each line that for_cells(line, visit) visits.
  template <class ForCells>
  void choose_lines(ForCells&& for_cells);
  static void read(std::span<const Block<T>> blocks, const Reads&, Parity, BeyondPair<T>* to);
  void fill(const BeyondPair<T>* from, const Places&);
  void start_messages(std::span<const Block<T>> blocks, Parity);

  std::vector<std::vector<BeyondPair<T>>> pairs_;  // of the blocks
  std::vector<Copy> copies_;
  Reads copied_;  // the chosen ones of copies_, and where they go
  Places copied_to_;
  std::vector<BeyondPair<T>> copying_;
  std::vector<Peer> peers_;
  parallel::Transfers transfers_;
};

template <class T>
template <class Solid, class Visit>
void PairsAcross<T>::for_cut(const Line& line, Solid&& solid, Visit&& visit) {
  const Int3 along = c[line.direction];
  const int axis = line.along_y ? 1 : 0;
  for (std::uint32_t n = 0; n < line.length; n += 64) {
    Int3 x = line.first;
    x[axis] += int(n);
    std::uint64_t cut = ~solid(line.block, x, axis) & solid(line.block, x + along, axis);
    if (line.length - n < 64) cut &= (std::uint64_t{1} << (line.length - n)) - 1;
    for (; cut; cut &= cut - 1) visit(n + std::uint32_t(std::countr_zero(cut)));
  }
}

template <class T>
template <class ForCells>
void PairsAcross<T>::choose_lines(ForCells&& for_cells) {
  copied_ = {}, copied_to_ = {};
  for (const Copy& copy : copies_)
    for_cells(copy.line, [&](std::uint32_t n) {
      copied_.add(copy.from_block, copy.line.direction, copy.from.first + n * copy.from.stride);
      copied_to_.add(copy.line.block, copy.place + n);
    });
  copying_.resize(copied_.cells.size());
  for (Peer& peer : peers_) {
    peer.reads = {}, peer.fills = {};
    for (const Sent& s : peer.sent)
      for_cells(s.line, [&](std::uint32_t n) {
        peer.reads.add(s.line.block, s.line.direction, s.from.first + n * s.from.stride);
      });
    for (const Received& r : peer.received)
      for_cells(r.line, [&](std::uint32_t n) { peer.fills.add(r.line.block, r.place + n); });
    peer.outgoing.resize(peer.reads.cells.size());
    peer.incoming.resize(peer.fills.places.size());
  }
}

template <class T>
template <class Solid>
void PairsAcross<T>::choose(Solid&& solid) {
  choose_lines([&](const Line& line, auto&& visit) { for_cut(line, solid, visit); });
}

}  // namespace silt::lbm

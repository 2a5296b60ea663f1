#pragma once
// A link from x along c_i may read what passes between x - c_i and x - 2 c_i (BeyondPair). Where x - c_i is a
// cell of another block, or of the same one through a period, that block has the pair, in slots of its own or
// of its ghost layer; this brings it. No slot of a pair is overwritten between the halo exchange and the next
// pass: where a ghost slot was returned to its home, it keeps what was sent.
//
// Twice the halo's bytes move, as both populations of a crossing do; only who reads them builds this.
#include <mpi.h>

#include <cstdint>
#include <span>
#include <vector>

#include "lbm/cut_links.hpp"
#include "lbm/domain.hpp"

namespace silt::lbm {

/// The pairs of cells x and directions i with x - c_i outside their block, brought from where x - c_i is. A
/// pair whose x - c_i is beyond a side of the domain that is not periodic does not exist; it stays 0.
template <class T>
class PairsAcross {
 public:
  /// `blocks` are the local ones, in the order of domain.blocks_of(rank).
  PairsAcross(const Domain&, MPI_Comm, std::span<const Block<T>> blocks);
  /// Call after the halo exchange, with the parity of the blocks then. The pair of an idle block means
  /// nothing. Blocks whose flag in `wanted` is not set keep old pairs (empty: all are wanted); what other
  /// ranks want of this one is not known here, so messages are whole.
  void exchange(std::span<const Block<T>> blocks, Parity, std::span<const char> wanted = {});
  /// The pairs of a local block lie in the order of its PlacesAcross.
  const BeyondPair<T>* of(int block) const { return pairs_[block].data(); }
  /// The bytes that this rank sends in one exchange.
  std::size_t message_bytes() const;
  /// The bytes held for pairs and messages.
  std::size_t bytes() const;

 private:
  struct Cells {  // of a local block, where pairs along a direction are read
    int block, direction;
    std::uint32_t first, stride, length;  // Block::cell of the first, and from each to the next
  };
  struct Places {  // of a local block
    int block;
    std::uint32_t first, length;
  };
  struct Copy {  // between two local blocks; as many places as cells
    Cells from;
    Places to;
  };
  struct Peer {
    int rank;
    std::vector<Cells> sent;
    std::vector<Places> received;
    std::vector<BeyondPair<T>> outgoing, incoming;
  };
  struct Builder;

  static bool follows(const Cells& run, const Cells& one);
  static bool follows(const Places& run, const Places& one);
  static void read(std::span<const Block<T>> blocks, const Cells&, Parity, BeyondPair<T>* to);
  void start_messages(std::span<const Block<T>> blocks, Parity);

  MPI_Comm comm_;
  std::vector<std::vector<BeyondPair<T>>> pairs_;  // of the blocks
  std::vector<Copy> copies_;
  std::vector<Peer> peers_;
  std::vector<MPI_Request> requests_;  // receives, then sends
};

}  // namespace silt::lbm

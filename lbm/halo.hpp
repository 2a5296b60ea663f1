#pragma once
// The ghost layer. A population that crosses out of a block along c_j has its slot (g, j) in a ghost cell g;
// its home is a slot of another block, of the same block through a periodic image, or, at a wall, the slot
// into which the wall turns it. One map from ghost slots to home slots therefore carries neighbours, periodic
// images and walls:
//     after an even pass (crossed parity) ghost slots are filled from their homes,
//     after an odd pass (settled parity) they are returned to them.
// Only crossing populations move: 5 a face cell, 1 an edge cell, one message per neighbouring rank and pass.
// Slots that follow one another at both ends move as runs. What a row exchanges with itself (a block that
// spans a periodic x axis) or with a wall across x touches two cache lines a population; the dense pass moves
// it row by row (Block::row_ends).
//
// A message may leave before the pass is done, once the rows that write it are: what crosses out is written
// by the collision of the cell it leaves alone. Nor does a cut link of the inside change it: the slot it
// writes holds what comes back to its cell, or is to, and that crosses no face.
#include <mpi.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lbm/domain.hpp"
#include "lbm/pass_order.hpp"
#include "parallel/transfers.hpp"

namespace silt::lbm {

template <class T>
class Halo {
 public:
  /// `blocks` are the local ones, in the order of domain.blocks_of(rank), `orders` those of their passes;
  /// gives the blocks their row ends. `force` is the uniform acceleration.
  Halo(const Domain&, MPI_Comm, std::span<Block<T>> blocks, std::span<const PassOrder> orders,
       const std::array<double, 3>& force);
  /// Call when the shells have collided: the messages that they alone write set out. `parity` is that of the
  /// blocks after the dense pass.
  void start(std::span<const Block<T>> blocks, Parity parity);
  /// Gives the messages under way a chance to move.
  void progress() { transfers_.progress(); }
  /// Call when the pass is done. Nothing moves into an idle block, nor from it to another of this rank: its
  /// slots mean nothing, and cut links cover every way into it.
  void exchange(std::span<Block<T>> blocks, std::span<const char> idle, Parity parity);
  /// The bytes that this rank sends in one exchange, and those of them that set out with the shells.
  std::size_t message_bytes() const;
  std::size_t early_bytes() const;

 private:
  struct Run {  // slots ghost, ghost + 1, ... and home, home + 1, ...
    std::uint32_t ghost, home, length;
  };
  struct Copy {  // between two local blocks
    int ghost_block, home_block;
    std::vector<Run> runs;
  };
  struct Wall {  // bounce: ghost and home in the same block, and what the wall's motion adds
    int block;
    T addend;
    std::vector<Run> runs;
  };
  struct OutletLink {
    std::uint32_t cell, ghost, home;  // cell: Block::slot(0) of it
    int direction;
  };
  struct Outlet {
    int block;
    double density_deviation;
    std::vector<OutletLink> links;  // by cell
  };
  struct Place {  // slots slot, slot + 1, ...
    int block;
    std::uint32_t slot, length;
  };
  struct Peer {
    int rank;
    bool early = true;                 // all that is sent is written by shells
    std::vector<Place> ghosts, homes;  // ghosts here whose home is there; homes here of ghosts there
    std::vector<T> ghost_buffer, home_buffer;
    std::size_t bytes() const;  // of one exchange
  };
  struct Builder;

  static void add_to(std::vector<Run>&, std::uint32_t ghost, std::uint32_t home);
  static void add_to(std::vector<Place>&, int block, std::uint32_t slot);

  void send(std::span<const Block<T>> blocks, Parity parity, std::size_t peer);
  void finish_peers(std::span<Block<T>> blocks, std::span<const char> idle, Parity parity);
  void apply_outlet(Block<T>&, const Outlet&, Parity) const;

  parallel::Transfers transfers_;
  std::array<double, 3> force_;
  std::vector<Copy> copies_;
  std::vector<Wall> walls_;
  std::vector<Outlet> outlets_;
  std::vector<Peer> peers_;
};

}  // namespace silt::lbm

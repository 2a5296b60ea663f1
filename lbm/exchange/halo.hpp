#pragma once
// The ghost layer. A population that leaves a block along c_j has its slot (g, j) in a ghost cell g. Its home
// is a slot of another block, of the same block through a periodic image, or, at a wall, the slot of the
// reflected population. One map from ghost slots to homes thus serves neighbours, periodic images and walls:
//     after an even pass (crossed parity) ghost slots are filled from their homes,
//     after an odd pass (settled parity) they are returned to them.
// Only populations that cross move: 5 per face cell, 1 per edge cell, one message per neighbour rank and
// pass. The exchange of a row with itself (a block that spans a periodic x axis) or with a wall across x
// touches two cache lines per population; the dense pass does it row by row (Block::row_ends).
//
// A message may leave before the pass ends, once the rows that write it have collided: only the collision of
// a cell writes the populations that leave it. Cut links of inner cells do not change it, since they write
// populations that return to their cells and cross no face.
#include <mpi.h>

#include <array>
#include <span>
#include <vector>

#include "lbm/blocks/domain.hpp"
#include "lbm/blocks/pass_order.hpp"
#include "lbm/exchange/slot_exchange.hpp"
#include "lbm/passes/outlet.hpp"
#include "lbm/passes/passes.hpp"

namespace silt::lbm {

template <class T, class Lattice = D3Q19>
class Halo {
  using Block = lbm::Block<T, Lattice>;

 public:
  /// Takes the local blocks in the order of domain.blocks_of(rank), and the orders of their passes; sets the
  /// row ends of the blocks.
  Halo(const Domain&, MPI_Comm, std::span<Block> blocks, std::span<const PassOrder> orders, const AtOutlets&,
       Device);
  /// Sends the messages that the shells alone write. Call after the shells have collided; `parity` is the
  /// parity after the pass.
  void start(Parity parity);
  void progress() { slots_.progress(); }
  /// Completes the exchange after a pass. Idle blocks receive nothing: cut links cover every way into them.
  void exchange(std::span<Block> blocks, std::span<const char> idle, Parity parity);
  void set_force(const std::array<double, 3>& force) { at_outlets_.force = force; }
  /// Recomputes the addends of walls from the present velocities of the domain's sides.
  void take_side_velocities(const Domain&, std::span<Block> blocks);
  /// Returns the bytes sent per exchange (see SlotExchange::message_bytes).
  std::size_t message_bytes(bool early_alone = false) const { return slots_.message_bytes(early_alone); }

 private:
  struct Walls {  // bounces
    SlotPairs pairs;
    Mirror<T> addends;                           // of each pair, from the motion of the wall
    std::vector<std::pair<Int3, int>> met = {};  // the sides that a pair meets, and its direction
  };
  struct Outlet {
    int block;
    SideCondition side;
    Mirror<OutletCell> cells;
    Mirror<OutletLink> links;
  };
  struct Builder;

  void apply_outlet(Block&, const Outlet&, Parity) const;

  AtOutlets at_outlets_;
  Device device_;
  SlotExchange<T> slots_;     // from homes to ghost slots; one array per block
  Mirror<const T*> sources_;  // of all blocks
  Mirror<T*> targets_;        // of blocks that are not idle
  std::vector<char> idle_;
  Walls walls_;
  std::vector<Outlet> outlets_;
};

}  // namespace silt::lbm

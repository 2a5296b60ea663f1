#pragma once
// The ghost layer. A population that crosses out of a block along c_j has its slot (g, j) in a ghost cell g;
// its home is a slot of another block, of the same block through a periodic image, or, at a wall, the slot
// into which the wall turns it. One map from ghost slots to home slots therefore carries neighbours, periodic
// images and walls:
//     after an even pass (crossed parity) ghost slots are filled from their homes,
//     after an odd pass (settled parity) they are returned to them.
// Only crossing populations move: 5 a face cell, 1 an edge cell, one message per neighbouring rank and pass.
// What a row exchanges with itself (a block that spans a periodic x axis) or with a wall across x touches two
// cache lines a population; the dense pass moves it row by row (Block::row_ends).
//
// A message may leave before the pass is done, once the rows that write it are: what crosses out is written
// by the collision of the cell it leaves alone. Nor does a cut link of the inside change it: the slot it
// writes holds what comes back to its cell, or is to, and that crosses no face.
#include <mpi.h>

#include <array>
#include <cstdint>
#include <memory>
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
  /// `blocks` are the local ones, in the order of domain.blocks_of(rank), `orders` those of their passes;
  /// gives the blocks their row ends. `force` is the uniform acceleration.
  Halo(const Domain&, MPI_Comm, std::span<Block> blocks, std::span<const PassOrder> orders,
       const std::array<double, 3>& force, Device);
  /// Call when the shells have collided: sends the messages that they alone write. `parity` is that after the
  /// pass.
  void start(Parity parity);
  void progress() { slots_.progress(); }
  /// Call when the pass is done. Nothing moves into an idle block: cut links cover every way into it.
  void exchange(std::span<Block> blocks, std::span<const char> idle, Parity parity);
  void set_force(const std::array<double, 3>& force) { force_ = force; }
  /// Takes the velocities that the sides of the domain have now.
  void take_side_velocities(const Domain&, std::span<Block> blocks);
  /// message_bytes counts as that of SlotExchange does.
  std::size_t message_bytes(bool early_alone = false) const { return slots_.message_bytes(early_alone); }

 private:
  struct Walls {  // bounces
    SlotPairs pairs;
    Mirror<T> addends;                           // of each pair, by the wall's motion
    std::vector<std::pair<Int3, int>> met = {};  // the sides that it meets along a direction
  };
  struct Outlet {
    int block;
    SideCondition side;
    Mirror<OutletCell> cells;
    Mirror<OutletLink> links;
  };
  struct Builder;

  void apply_outlet(Block&, const Outlet&, Parity) const;

  std::array<double, 3> force_;
  Device device_;
  SlotExchange<T> slots_;     // from homes to ghosts; an array is a block
  Mirror<const T*> sources_;  // the blocks
  Mirror<T*> targets_;        // those that are not idle
  std::vector<char> idle_;
  Walls walls_;
  std::vector<Outlet> outlets_;
};

}  // namespace silt::lbm

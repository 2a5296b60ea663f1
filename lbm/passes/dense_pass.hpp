#pragma once
// The dense pass of a rank: which rows of which blocks collide when, the parity of the populations, and the
// cells that a pass finds too fast.
#include <mpi.h>

#include <span>
#include <vector>

#include "lbm/blocks/block.hpp"
#include "lbm/blocks/domain.hpp"
#include "lbm/blocks/pass_order.hpp"
#include "lbm/collision/stream_collide.hpp"

namespace silt::lbm {

template <class T>
struct CollisionRates;

/// An array that blocks [first, end) of a rank share, and the box of its cells. A pass goes over all of them
/// where that takes less time than over each of the blocks; nobody reads those that are of no block.
template <class T>
struct SharedArray {
  Block<T> whole;
  int first, end;
};

template <class T>
class DensePass {
 public:
  /// Refers to the rates and the blocks.
  DensePass(const Domain&, MPI_Comm, Device, const CollisionRates<T>&, std::vector<Block<T>>&);

  /// Passes over each block alone from now on.
  void pass_no_array_whole();
  /// Lets a block without fluid cells skip collisions; its slots then hold no valid values.
  void set_idle(int b, bool idle) { idle_[b] = idle; }
  std::span<const char> idle() const { return idle_; }
  std::span<const PassOrder> orders() const { return orders_; }  // of the blocks

  /// Collides the shells of the blocks, and the arrays that are passed whole.
  void begin();
  /// Returns the number of parts of a block that are left to collide.
  int parts(int b) const { return idle_[b] || !in_parts_[b] ? 0 : orders_[b].parts(); }
  void collide(int b, RowRange rows) { pass_over(b, blocks_[b], rows); }
  /// Flips the parity.
  void end();

  Parity parity() const { return parity_; }
  /// Returns the number of passes, which selects the planes watched in a pass (WatchedPlanes).
  std::int64_t passes() const { return passes_; }
  void set_passes(std::int64_t done) { passes_ = done; }
  /// The cells of watched planes, solid ones included, whose speed was above that of sound or not a number
  /// when the last pass began.
  struct Fast {
    int block;
    Int3 cell;
    double speed;
  };
  const std::vector<Fast>& fast_cells() const { return fast_cells_; }

 private:
  void pass_over(int number, Block<T>&, RowRange);
  void see_fast(SharedArray<T>&, const FastCell&);

  Device device_;
  const CollisionRates<T>& rates_;
  std::vector<Block<T>>& blocks_;
  std::vector<SharedArray<T>> passed_whole_;
  std::vector<PassOrder> orders_;
  std::vector<char> idle_, in_parts_;  // in_parts_: not of an array that is passed whole
  Parity parity_ = Parity::settled;
  std::int64_t passes_ = 0;
  std::vector<Fast> fast_cells_;
};

}  // namespace silt::lbm

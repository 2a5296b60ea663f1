#pragma once
// The fluid as a user of the library holds it: local blocks, one pass of collision and streaming, and
// density, velocity and momentum flux, computed on request only.
#include <mpi.h>

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "lbm/blocks/domain.hpp"
#include "lbm/blocks/local_blocks.hpp"
#include "lbm/blocks/moments.hpp"
#include "lbm/collision/collision_model.hpp"
#include "lbm/exchange/halo.hpp"
#include "lbm/passes/dense_pass.hpp"
#include "lbm/passes/passes.hpp"

namespace silt::lbm {

template <class T>
struct CollisionRates;
template <class T>
struct HeatRates;
struct HeatSpec;

struct LocalCell {
  int block;
  Int3 cell;
};

/// Returns half of what an acceleration adds to population i of fluid at rest: 3/2 w c.F (equation 6).
double half_push(const std::array<double, 3>& force, int i);

/// What the fluid carries: it collides in the passes of the fluid, and its exchange is a part of the fluid's.
class Carried {
 public:
  virtual ~Carried() = default;
  /// Sends what is ready: the shells have collided. `parity` is the parity after the pass.
  virtual void start_exchange(Parity parity) = 0;
  /// Completes the pass.
  virtual void exchange() = 0;
};

template <class T>
class Fluid {
 public:
  using Number = T;
  using Lattice = D3Q19;
  /// Blocks take the arrays of `before`, if given, that were made for the same boxes of cells: cells of both
  /// keep their values, others have any (move_populations). Throws std::invalid_argument for a relaxation
  /// time of 1/2 or less.
  Fluid(const Domain&, const CollisionSpec&, MPI_Comm, Device = Device::cpu, const Fluid* before = nullptr);
  ~Fluid();

  const Domain& domain() const { return domain_; }
  const CollisionSpec& spec() const { return spec_; }
  std::vector<Block<T>>& blocks() { return blocks_; }
  const std::vector<Block<T>>& blocks() const { return blocks_; }
  Parity parity() const { return pass_.parity(); }
  const Halo<T>& halo() const { return halo_; }
  MPI_Comm comm() const { return comm_; }
  Device device() const { return device_; }
  /// Returns whether callers should do a pass in parts with other work after each, since the populations of a
  /// part are then still in the CPU's cache.
  bool is_in_parts() const { return device_ == Device::cpu; }

  /// Sets the acceleration from the next collision on.
  void set_force(const std::array<double, 3>&);
  /// Carries a temperature from now on, in as many blocks of the same cells at the same offsets. It must live
  /// as long as passes are done.
  void carry(Carried&, const HeatSpec&, std::span<Block<T, D3Q7>>);
  /// Sets the velocity of a side of the domain from the next pass on.
  void set_side_velocity(int side, const std::array<double, 3>&);
  /// Declares that from now on cells of block b with links are all in these rows (excess.hpp). A pass must
  /// come before the next call.
  void hold_excess(int b, std::span<const RowRange> rows) {
    blocks_[b].hold_no_more_excess();
    for (const RowRange& range : rows)
      blocks_[b].hold_excess(range, T(spec_.bulk_stress_given_up()), device_);
  }
  /// Subtracts the excess of all cells now instead of at the next collision: the populations that arrive are
  /// then final, but no longer those that links returned. Keeps the amounts for given_up() until
  /// forget_given_up(); until then it does nothing again.
  void take_and_keep_excess();
  void forget_given_up() { is_given_up_ = false; }
  /// Returns what populations along c_i and against it (i > 0) of a cell lost in take_and_keep_excess().
  double given_up(int b, std::ptrdiff_t cell, int i) const {
    if (!is_given_up_ || given_up_[b].empty()) return 0;
    return given_up_[b][cell][i < 7 ? 0 : 1];
  }
  /// Lets a block without fluid cells skip collisions; its slots then hold no valid values.
  void set_idle(int b, bool idle) { pass_.set_idle(b, idle); }
  std::span<const char> idle() const { return pass_.idle(); }
  /// Collides and streams all blocks that are not idle, and flips the parity. Messages to other ranks leave
  /// as soon as their values are written. Call exchange() next.
  void stream_collide();
  /// The same pass in pieces, with other work in between: begin_pass(), then collide() for the parts of each
  /// block (pass_order.hpp) in their order, then end_pass().
  void begin_pass();
  int parts(int b) const { return pass_.parts(b); }
  void collide(int b, int part) { collide_rows(b, pass_order(b).rows_of(part)); }
  void end_pass() { pass_.end(); }
  std::int64_t passes() const { return pass_.passes(); }
  void set_passes(std::int64_t done) { pass_.set_passes(done); }
  const std::vector<typename DensePass<T>::Fast>& fast_cells() const { return pass_.fast_cells(); }
  const PassOrder& pass_order(int b) const { return pass_.orders()[b]; }
  std::span<const PassOrder> pass_orders() const { return pass_.orders(); }
  /// Completes the pass: sends the remaining messages, waits for all, fills or returns ghost slots, and
  /// applies the walls of the domain. Cut links at the rim of blocks come after it.
  void exchange() {
    halo_.exchange(blocks_, idle(), parity());
    if (carried_) carried_->exchange();
  }

  T& arriving(int b, Int3 local_cell, int i) {
    return blocks_[b].data()[blocks_[b].arriving(i, parity()) + blocks_[b].cell(local_cell)];
  }
  T arriving(int b, Int3 local_cell, int i) const {
    return blocks_[b].data()[blocks_[b].arriving(i, parity()) + blocks_[b].cell(local_cell)];
  }
  /// Copy population i that arrives at the cells of a box of local cells, x fastest.
  void read(int b, const CellBox&, int i, double* g) const;
  void write(int b, const CellBox&, int i, const double* g);
  /// Returns the population that left a cell along i in the last pass; valid until the next one.
  T leaving(int b, Int3 local_cell, int i) const {
    return blocks_[b].data()[blocks_[b].leaving(i, parity()) + blocks_[b].cell(local_cell)];
  }
  Moments moments(int b, Int3 local_cell) const;
  /// Returns the moments of single cells, in order, after giving up their excess; valid until the next call.
  std::span<const Moments> moments(std::span<const LocalCell>);
  /// Lets the cell and its neighbours have an excess.
  void hold_excess_around(const LocalCell& at) {
    const auto& [b, x] = at;
    blocks_[b].hold_excess({x.y - 1, x.y + 2, x.z - 1, x.z + 2}, T(spec_.bulk_stress_given_up()), device_);
  }
  /// Adds masses (quanta of excess.hpp) to single cells at their next collision; a cell may get several.
  void give_masses(std::span<const LocalCell>, std::span<const std::int64_t>);
  /// Returns single cells as passes address them, in these lists.
  ListedCells<T> listed(std::span<const LocalCell>, CellLists<T>&);
  /// Returns the cells of these lists after the parity or the excess of blocks has changed.
  ListedCells<T> listed_again(CellLists<T>&);
  /// Returns a block as passes over its cells see it, until its parity or excess changes.
  typename ListedCells<T>::Block listed_block(int b);
  void moments(int b, const CellBox&, MomentArrays&) const;
  /// Return the totals of rows of cells; for many rows, in memory that the device reaches.
  CellTotals totals(int b, const LocalRows&) const;
  void totals(int b, std::span<const LocalRows>, CellTotals*) const;
  std::array<double, 3> velocity(const Moments& m) const { return velocity_of(m, spec_.force); }
  /// Returns half the amount that the force adds to population i of fluid at rest.
  double half_push(int i) const { return lbm::half_push(spec_.force, i); }
  std::size_t bytes() const;

 private:
  void collide_rows(int b, RowRange rows) { pass_.collide(b, rows), halo_.progress(); }
  template <class Sum>
  auto for_arriving(int b, Int3 local_cell, Sum&& sum) const;
  void keep_excess(std::size_t b);

  Domain domain_;
  CollisionSpec spec_;
  std::unique_ptr<CollisionRates<T>> rates_;
  std::unique_ptr<HeatRates<T>> heat_rates_;  // this and the next: of what is carried; null: nothing
  Carried* carried_ = nullptr;
  MPI_Comm comm_;
  Device device_;
  std::vector<Block<T>> blocks_;
  DensePass<T> pass_;
  CellLists<T> listed_{device_};  // this and the following: single cells for passes
  Mirror<Moments> cell_moments_{device_};
  Mirror<std::int64_t> cell_masses_{device_};
  std::vector<std::vector<std::array<T, 2>>> given_up_;  // of the blocks: along an axis, along a diagonal
  bool is_given_up_ = false;
  Halo<T> halo_;
};

/// Copies the populations that arrive in `from` to the cells of `to`, two cuts of one domain for the same
/// ranks, from rank to rank, except for blocks that share their array. One direction at a time, so that
/// messages hold a nineteenth of the populations (levels/change_levels.cpp). Collective.
template <class Field>
void move_populations(const Field& from, Field& to);

}  // namespace silt::lbm

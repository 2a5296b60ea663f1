#pragma once
// The fluid as its user holds it: the local blocks, one pass of collision and streaming, and density,
// velocity and momentum flux where they are asked for (never computed otherwise).
#include <mpi.h>

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "lbm/blocks/domain.hpp"
#include "lbm/blocks/moments.hpp"
#include "lbm/blocks/pass_order.hpp"
#include "lbm/collision/collision_model.hpp"
#include "lbm/collision/stream_collide.hpp"
#include "lbm/exchange/halo.hpp"
#include "lbm/passes/passes.hpp"

namespace silt::lbm {

template <class T>
struct CollisionRates;

struct LocalCell {
  int block;
  Int3 cell;
};

/// Returns half of what an acceleration adds to population i of fluid at rest, 3/2 w c.F (equation 6).
double half_push(const std::array<double, 3>& force, int i);

template <class T>
class Fluid {
 public:
  using Number = T;
  using Lattice = D3Q19;
  /// Throws std::invalid_argument for a relaxation time of 1/2 or less.
  Fluid(const Domain&, const CollisionSpec&, MPI_Comm, Device = Device::cpu);
  ~Fluid();

  const Domain& domain() const { return domain_; }
  const CollisionSpec& spec() const { return spec_; }
  std::vector<Block<T>>& blocks() { return blocks_; }
  const std::vector<Block<T>>& blocks() const { return blocks_; }
  Parity parity() const { return parity_; }
  const Halo<T>& halo() const { return halo_; }
  MPI_Comm comm() const { return comm_; }
  Device device() const { return device_; }
  /// Returns whether a pass is to be done in parts, with something else after each: what a part has written
  /// is then in a cache of the processor.
  bool is_in_parts() const { return device_ == Device::cpu; }

  /// The acceleration from the next collision on.
  void set_force(const std::array<double, 3>&);
  /// The velocity of a side of the domain from the next pass on.
  void set_side_velocity(int side, const std::array<double, 3>&);
  /// The cells of a block that have links are all in these rows from now on (excess.hpp). A pass comes before
  /// the next call.
  void hold_excess(int b, std::span<const RowRange> rows) {
    blocks_[b].hold_no_more_excess();
    for (const RowRange& range : rows)
      blocks_[b].hold_excess(range, T(spec_.bulk_stress_given_up()), device_);
  }
  /// All cells give up their excess, as they would when they collide: what arrives is complete then, but is
  /// no longer what came back along links.
  void take_excess();
  /// As take_excess(), and what a cell gave up can be asked for until forget_given_up().
  void take_and_keep_excess();
  void forget_given_up() { is_given_up_ = false; }
  /// Returns what the populations along c_i and against it, i > 0, of a cell by its Block::cell lost thereby.
  double given_up(int b, std::ptrdiff_t cell, int i) const {
    if (!is_given_up_ || given_up_[b].empty()) return 0;
    return given_up_[b][cell][i < 7 ? 0 : 1];
  }
  /// A block without a fluid cell need not collide; what its slots hold means nothing then.
  void set_idle(int b, bool idle) { idle_[b] = idle; }
  /// Every cell of the blocks that are not idle collides; parity flips. Messages to other ranks set out as
  /// soon as what they carry is there. Call exchange() next.
  void stream_collide();
  /// These are the same pass in pieces, with something else in between: it begins, the parts of each block
  /// (pass_order.hpp) are collided in their order, and it ends.
  void begin_pass();
  int parts(int b) const { return idle_[b] ? 0 : orders_[b].parts(); }
  void collide(int b, int part) { collide_rows(b, orders_[b].rows_of(part)); }
  void end_pass();
  /// The number of passes decides which planes are watched in a pass (WatchedPlanes).
  std::int64_t passes() const { return passes_; }
  void set_passes(std::int64_t done) { passes_ = done; }
  /// The cells of the planes looked at that were faster than sound when the last pass began, or whose
  /// speed was not a number; solid ones too.
  struct Fast {
    int block;
    Int3 cell;
    double speed;
  };
  const std::vector<Fast>& fast_cells() const { return fast_cells_; }
  const PassOrder& pass_order(int b) const { return orders_[b]; }
  /// Fills or returns ghost slots and applies domain walls, for the pass just done: sends what messages are
  /// left and waits for all. Cut links of the rim come after it.
  void exchange() { halo_.exchange(blocks_, idle_, parity_); }

  T& arriving(int b, Int3 local_cell, int i) {
    return blocks_[b].data()[blocks_[b].arriving(i, parity_) + blocks_[b].cell(local_cell)];
  }
  T arriving(int b, Int3 local_cell, int i) const {
    return blocks_[b].data()[blocks_[b].arriving(i, parity_) + blocks_[b].cell(local_cell)];
  }
  /// Read or write population i arriving at the cells of a box of local cells, x fastest.
  void read(int b, const CellBox&, int i, double* g) const;
  void write(int b, const CellBox&, int i, const double* g);
  /// The population that left a cell along i in the last pass (until the next one).
  T leaving(int b, Int3 local_cell, int i) const {
    return blocks_[b].data()[blocks_[b].leaving(i, parity_) + blocks_[b].cell(local_cell)];
  }
  Moments moments(int b, Int3 local_cell) const;
  /// Returns the moments of single cells without their excess, in their order; they are there until the next
  /// call.
  std::span<const Moments> moments(std::span<const LocalCell>);
  /// Returns the density deviations of single cells: a tenth of what moments bring from a device.
  std::span<const double> densities(std::span<const LocalCell>);
  /// Gives single cells these masses, in quanta of excess.hpp, when they collide next; a cell may get
  /// several.
  void give_masses(std::span<const LocalCell>, std::span<const std::int64_t>);
  /// Returns where a pass finds single cells; the list holds until the next call of listed() or moments().
  ListedCells<T> listed(std::span<const LocalCell>);
  void moments(int b, const CellBox&, MomentArrays&) const;
  /// Return the totals of rows of cells; those of many rows lie in memory that the device reaches.
  CellTotals totals(int b, const LocalRows&) const;
  void totals(int b, std::span<const LocalRows>, CellTotals*) const;
  std::array<double, 3> velocity(const Moments& m) const { return velocity_of(m, spec_.force); }
  void set_equilibrium(int b, Int3 local_cell, double density_deviation,
                       const std::array<double, 3>& velocity);
  /// Half of what the force adds to population i of fluid at rest.
  double half_push(int i) const { return lbm::half_push(spec_.force, i); }
  std::size_t bytes() const;

 private:
  void collide_rows(int b, RowRange);
  void pass_over(std::size_t b, RowRange);
  template <class Sum>
  auto for_arriving(int b, Int3 local_cell, Sum&& sum) const;
  void keep_excess(std::size_t b);

  Domain domain_;
  CollisionSpec spec_;
  std::unique_ptr<CollisionRates<T>> rates_;
  MPI_Comm comm_;
  Device device_;
  std::vector<Block<T>> blocks_;
  std::vector<PassOrder> orders_;  // of the blocks
  std::vector<char> idle_;
  Parity parity_ = Parity::settled;
  std::int64_t passes_ = 0;
  std::vector<Fast> fast_cells_;
  // of single cells, for passes
  Mirror<typename ListedCells<T>::Cell> listed_cells_{device_};
  Mirror<typename ListedCells<T>::Block> listed_blocks_{device_};
  Mirror<Moments> cell_moments_{device_};
  Mirror<double> cell_densities_{device_};
  Mirror<std::int64_t> cell_masses_{device_};
  std::vector<std::vector<std::array<T, 2>>> given_up_;  // of the blocks: along an axis, along a diagonal
  bool is_given_up_ = false;
  Halo<T> halo_;
};

/// Collective. Gives every cell of `to` what arrives there in `from`, straight from rank to rank: two cuts of
/// one domain for the same ranks. A direction at a time, so that messages hold a nineteenth of the
/// populations (move_populations.cpp).
template <class Field>
void move_populations(const Field& from, Field& to);

}  // namespace silt::lbm

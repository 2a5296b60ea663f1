#pragma once
// The fluid with bodies in it, whatever the precision of its populations: the passes of Algorithm 2 that
// touch the lattice, and what may be asked of it between steps. Built for a scene: a pass the scene does not
// need does nothing.
#include <mpi.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "coupler/flow_totals.hpp"
#include "coupler/mapping/cell_bits.hpp"
#include "coupler/mass_correction.hpp"
#include "coupler/stage.hpp"
#include "lbm/domain.hpp"
#include "lbm/moments.hpp"
#include "rigid/bodies/body_set.hpp"

namespace silt::coupler {

class ParallelBodyExchange;
struct BodyChanges;
class WorkMap;
struct Case;
struct WorkCosts;

/// Cells that changed sides on this rank in the last mapping (ghost cells not counted), and cut links held.
struct MappingCounts {
  std::uint64_t covered = 0, uncovered = 0, links = 0;
};

/// Force and torque, lattice units, world frame.
struct Load {
  rigid::Vec3 force = rigid::Vec3::Zero(), torque = rigid::Vec3::Zero();
};

class Flow {
 public:
  virtual ~Flow() = default;

  // ---- the passes of a step, in this order (Algorithm 2) ----
  /// Object mapping: puts bodies that moved further than the tolerance onto the lattice at their present
  /// poses, rebuilds links where something changed and refills uncovered cells. Renews the mapping pose of
  /// every body held. The changes are those since the last step; they stay there until the step's last pass.
  virtual void map_bodies(rigid::BodySet&, const BodyChanges&) = 0;
  /// With it the links that touch no ghost cell, while their populations are in cache. The clock counts what
  /// they take as force evaluation.
  /// Begins with what the last step left under way: ForceOutOfRange, on every rank alike, if a body's sums
  /// were out of range in that step.
  virtual void stream_collide(StepClock&) = 0;
  /// LBM communication: ghost layers and domain walls.
  virtual void communicate() = 0;
  /// Force evaluation: what the other surfaces return, and force and torque on bodies added to the rows'
  /// accumulators (at the owners). With implicit coupling also solves for the bodies' new velocity and
  /// returns with it.
  virtual void evaluate_forces(rigid::BodySet&) = 0;

  // ---- between steps ----
  virtual const lbm::Domain& domain() const = 0;
  virtual int blocks() const = 0;                      // of this rank
  virtual const lbm::CellBox& block(int b) const = 0;  // global cells
  virtual const CellBits& solid(int b) const = 0;      // cells of a block
  bool is_fluid(int b, lbm::Int3 local_cell) const { return !solid(b).test(local_cell); }
  virtual lbm::Moments moments(int b, lbm::Int3 local_cell) const = 0;
  /// Those of cells that follow each other along x; of solid ones they mean nothing.
  virtual void moments(int b, lbm::Int3 first_local_cell, int cells, lbm::MomentsRow&) const = 0;
  struct Fast {
    lbm::Int3 cell;  // global
    double speed;    // infinite for what is not a number
  };
  /// Returns the fastest of this rank's fluid cells that the last pass found to be faster than
  /// lbm::speed_of_sound when it began; of several the first, z before y before x.
  virtual std::optional<Fast> too_fast() const = 0;
  std::array<double, 3> velocity(const lbm::Moments& m) const { return lbm::velocity_of(m, body_force_); }
  /// Returns the sum of the velocities of the fluid cells.
  rigid::Vec3 velocity_sum(const FlowTotals& t) const {
    return rigid::Vec3(t.momentum.data()) +
           0.5 * static_cast<double>(t.fluid_cells) * rigid::Vec3(body_force_.data());
  }
  virtual void set_equilibrium(int b, lbm::Int3 local_cell, double density_deviation,
                               const std::array<double, 3>& velocity) = 0;
  /// Population i arriving at a cell, whatever the parity: for checkpoints. Exact in double for either
  /// precision.
  virtual double arriving(int b, lbm::Int3 local_cell, int i) const = 0;
  virtual void set_arriving(int b, lbm::Int3 local_cell, int i, double g) = 0;
  virtual std::size_t bytes() const = 0;      // populations of this rank
  virtual MappingCounts mapping() const = 0;  // of the last step, this rank

  /// Collective. First call after the bodies exist and before the first step: maps without refilling, at the
  /// mapping poses (fresh bodies: their poses). After a restart: set_arriving everything and
  /// set_mass_correction first.
  virtual void start(rigid::BodySet&) = 0;
  /// Collective, before start() and in the place of set_arriving and set_mass_correction: takes over from the
  /// same fluid in other blocks.
  virtual void take_over(const Flow&) = 0;
  /// Adds the work that the bodies of a set make in the blocks of this rank, as they are mapped.
  virtual void add_work(const rigid::BodySet&, const WorkCosts&, WorkMap&) const = 0;
  /// Collective; ForceOutOfRange as of stream_collide. Cells are added up once between two changes.
  virtual FlowTotals totals() const = 0;
  /// hash_fluid of this rank (state_hash.hpp).
  virtual std::uint64_t hash() const = 0;
  /// side_force of this rank (side_force.hpp).
  virtual std::array<rigid::FixedSum, 3> side_force(int axis, bool upper) const = 0;
  /// This rank's share of the force and torque of the fluid on a wall in the last step (`wall` counts the
  /// walls' rows), the torque about its position, in lbm::link_quantum. Zero before the first step.
  virtual std::array<std::int64_t, 6> wall_load(std::size_t wall) const = 0;
  /// What bodies that came and went did to the momentum of the fluid and the impulse debts, of this rank, in
  /// all steps since the flow was made: the fluid they took the place of, and that which took theirs.
  virtual rigid::FixedVec3 momentum_brought() const = 0;
  virtual const MassCorrectionState& mass_correction() const = 0;
  virtual void set_mass_correction(const MassCorrectionState&) = 0;

 protected:
  explicit Flow(const std::array<double, 3>& body_force) : body_force_(body_force) {}

 private:
  std::array<double, 3> body_force_;
};

/// Returns the domain a case asks for, cut for a number of ranks. std::invalid_argument if it cannot be.
lbm::Domain make_domain(const Case&, int ranks);
/// Needs case.fluid. The exchange tells who owns what (force sums go to owners).
std::unique_ptr<Flow> make_flow(const Case&, const lbm::Domain&, MPI_Comm, const ParallelBodyExchange&);

}  // namespace silt::coupler

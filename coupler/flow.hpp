#pragma once
// The fluid with bodies, for either precision of its populations: the passes of Algorithm 2 that act on the
// lattice. Passes that a scene does not need do nothing. fluid_fields.hpp gives access to cells between
// steps, flow_account.hpp to the balance of mass and momentum.
#include <mpi.h>

#include <memory>

#include "coupler/flow_account.hpp"
#include "coupler/fluid_fields.hpp"
#include "coupler/stages.hpp"
#include "rigid/bodies/body_set.hpp"

namespace silt::coupler {

class FlowControl;
class ParallelBodyExchange;
struct BodyChanges;
struct FlowSpec;

class Flow {
 public:
  virtual ~Flow() = default;
  /// Returns the number of lattices. Cells of lattice `level` are 2^level finest cells wide.
  virtual int levels() const = 0;
  virtual FluidFields& fields(int level = 0) = 0;
  /// Returns FluidFields::too_fast of a level without completing cells as fields() does, which takes time.
  virtual std::optional<FluidFields::Fast> too_fast(int level) = 0;
  /// Returns the seconds that passes of a coarser level took on this rank, a part of Stage::stream_collide.
  virtual double seconds(int level) const = 0;
  virtual FlowAccount& account() = 0;
  /// Returns this rank's share of the heat that a wall got from the fluid in the last step, in
  /// lbm::heat_quantum; `wall` counts the rows of walls. Zero without [heat].
  virtual std::int64_t heat_of_wall(std::size_t) const { return 0; }
  const FluidFields& fields(int level = 0) const { return const_cast<Flow*>(this)->fields(level); }
  const FlowAccount& account() const { return const_cast<Flow*>(this)->account(); }
  /// Collective; throws like FlowAccount::totals.
  FlowTotals totals() const {
    fields(0);  // completes the cells
    return account().totals();
  }

  /// Calls visit(fields) for each level, the finest first.
  template <class Visit>
  void for_levels(Visit&& visit) const {
    for (int level = 0; level < levels(); ++level) visit(fields(level));
  }

  /// Sets the body force and the velocities of the sides for step `steps_done + 1`. Call before each step
  /// after start(). Collective, but waits for no other rank.
  virtual void drive(std::int64_t steps_done) = 0;
  /// Returns null if no superficial velocity is prescribed.
  virtual FlowControl* control() = 0;

  // ---- the passes of a step, in this order (Algorithm 2) ----
  /// Object mapping: maps bodies that moved further than the tolerance at new mapping poses, rebuilds links
  /// where cells or surfaces changed, and refills uncovered cells. `changes` are those since the last step
  /// and must stay valid until the last pass of this step.
  virtual void map_bodies(rigid::BodySet&, const BodyChanges&) = 0;
  /// Streams and collides and, where cells are passed in parts, applies links that touch no ghost cell as
  /// soon as their cells have collided and are still cached; the clock counts their time as force evaluation.
  /// First completes the sums of the last step: throws ForceOutOfRange, on every rank alike, if a body's sums
  /// were out of range then.
  virtual void stream_collide(StepClock&) = 0;
  /// LBM communication: exchanges ghost layers and applies domain walls.
  virtual void communicate() = 0;
  /// Force evaluation: applies all other links, and adds force and torque on bodies to the accumulators of
  /// their owners. With implicit coupling also solves for the new velocities of the bodies.
  virtual void evaluate_forces(rigid::BodySet&) = 0;

  /// Fixes the mapping poses of bodies, whatever their velocities, until hold_bodies(false), which resets the
  /// account and the number of passes. Collective, between steps of the coarsest cells.
  virtual void hold_bodies(bool) = 0;

  // ---- before the first step ----
  /// Continues after a restart from a step with this account of mass. Call once populations are written.
  virtual void resume(std::int64_t step, rigid::FixedSum mass_taken) = 0;
  /// Copies the state of a flow with the same fluid in other blocks, instead of writing populations and
  /// resume(). Collective.
  virtual void take_over(const Flow&) = 0;
  /// Maps bodies at their mapping poses (new bodies: their poses) without refilling. Collective; call last,
  /// when all bodies exist.
  virtual void start(rigid::BodySet&) = 0;
};

/// Returns the domain, cut for a number of ranks. Throws std::invalid_argument if it cannot be cut.
lbm::Domain make_domain(const FlowSpec&, int ranks);
/// Makes a flow; the spec must have a fluid. `substeps` is that of the bodies per step. The exchange knows
/// the owners, which receive the sums of forces. A flow that is to take over another one is given it.
std::unique_ptr<Flow> make_flow(const FlowSpec&, const lbm::Domain&, MPI_Comm, ParallelBodyExchange&,
                                int substeps, const Flow* before = nullptr);

}  // namespace silt::coupler

#pragma once
// The fluid with bodies in it, whatever the precision of its populations: the passes of Algorithm 2 that
// touch the lattice. Built for a scene: a pass the scene does not need does nothing. What may be read and
// written of its cells between steps is in fluid_fields.hpp, what is counted in flow_account.hpp.
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

/// The links of surfaces within a block are applied, and bodies solved for that have no others, while the
/// dense pass runs, as soon as their cells have collided and are still in a cache, or all after the pass. No
/// bit depends on the schedule.
enum class LinkSchedule { interleaved, sequential };

class Flow {
 public:
  virtual ~Flow() = default;
  /// The lattices, of which 0 is the finest: a cell of each is 2^level of its cells wide.
  virtual int levels() const = 0;
  virtual FluidFields& fields(int level = 0) = 0;
  /// FluidFields::too_fast of a level. (To ask for fields completes their cells first, which takes time.)
  virtual std::optional<FluidFields::Fast> too_fast(int level) = 0;
  /// Returns what passes of a coarser level have taken on this rank, as a part of Stage::stream_collide.
  virtual double seconds(int level) const = 0;
  virtual FlowAccount& account() = 0;
  const FluidFields& fields(int level = 0) const { return const_cast<Flow*>(this)->fields(level); }
  const FlowAccount& account() const { return const_cast<Flow*>(this)->account(); }
  /// Collective; errors as of FlowAccount::totals.
  FlowTotals totals() const {
    fields(0);  // are complete from here on
    return account().totals();
  }

  /// Calls visit(fields) for each level, the finest first.
  template <class Visit>
  void for_levels(Visit&& visit) const {
    for (int level = 0; level < levels(); ++level) visit(fields(level));
  }

  /// Gives the fluid the body force and its sides the velocities of the step that follows so many; to be
  /// called before each, once the flow has started. Collective, but waits for nobody.
  virtual void drive(std::int64_t steps_done) = 0;
  /// Null where no superficial velocity is asked for.
  virtual FlowControl* control() = 0;

  // ---- the passes of a step, in this order (Algorithm 2) ----
  /// Object mapping: puts bodies that moved further than the tolerance onto the lattice at their present
  /// poses, rebuilds links where something changed and refills uncovered cells. Renews the mapping pose of
  /// every body held. The changes are those since the last step; they stay there until the step's last pass.
  virtual void map_bodies(rigid::BodySet&, const BodyChanges&) = 0;
  /// Streams and collides and, if the schedule is interleaved, applies the links that touch no ghost cell;
  /// the clock counts their time as force evaluation. It begins with what the last step left under way:
  /// ForceOutOfRange, on every rank alike, if a body's sums were out of range in that step.
  virtual void stream_collide(StepClock&) = 0;
  /// LBM communication: ghost layers and domain walls.
  virtual void communicate() = 0;
  /// Force evaluation: what the other surfaces return, and force and torque on bodies added to the rows'
  /// accumulators (at the owners). With implicit coupling also solves for the bodies' new velocity and
  /// returns with it.
  virtual void evaluate_forces(rigid::BodySet&) = 0;

  /// Until hold_bodies(false) bodies stay where they are on the lattice, whatever their velocities; then the
  /// account and the number of passes begin again. Collective, between steps of the coarsest cells.
  virtual void hold_bodies(bool) = 0;

  /// Interleaved until this is called.
  virtual void set_schedule(LinkSchedule) = 0;

  // ---- before the first step ----
  /// After a restart, once the populations are written: goes on from a step with this account of the mass.
  virtual void resume(std::int64_t step, rigid::FixedSum mass_taken) = 0;
  /// Collective, in the place of writing populations and resume(): takes over from the same fluid in other
  /// blocks.
  virtual void take_over(const Flow&) = 0;
  /// Collective, after these, once the bodies exist: maps without refilling, at the mapping poses (fresh
  /// bodies: their poses).
  virtual void start(rigid::BodySet&) = 0;
};

/// Returns the domain cut for a number of ranks. std::invalid_argument if it cannot be.
lbm::Domain make_domain(const FlowSpec&, int ranks);
/// Needs a fluid. Bodies take so many sub-steps in a step. The exchange tells who owns what (force sums go to
/// owners).
std::unique_ptr<Flow> make_flow(const FlowSpec&, const lbm::Domain&, MPI_Comm, ParallelBodyExchange&,
                                int substeps);

}  // namespace silt::coupler

#pragma once
// The balance of the fluid between steps: its mass and momentum, the changes by bodies, and whether a force
// was out of range. Sums over ranks start at the end of a step and are completed when they are needed.
#include <mpi.h>

#include <array>
#include <cstdint>
#include <vector>

#include "coupler/fluid_fields.hpp"
#include "coupler/forces/fluid_forces.hpp"
#include "parallel/collectives.hpp"
#include "parallel/pending_sums.hpp"
#include "rigid/math/exact_sum.hpp"

namespace silt::coupler {

/// Cells of this rank (no ghosts) that turned solid or fluid in the last mapping, and its cut links.
struct MappingCounts {
  std::uint64_t covered = 0, uncovered = 0, links = 0;
};

class FlowAccount {
 public:
  FlowAccount(const FluidFields& finest, MPI_Comm comm) : levels_{&finest}, comm_(comm) {}
  void add_level(const FluidFields& coarser) { levels_.push_back(&coarser); }

  // ---- asked between steps ----
  /// Returns the totals over all ranks. Collective; throws ForceOutOfRange, on every rank alike, if a body's
  /// sums were out of range in the last step. Cells must be complete, as Flow::totals ensures.
  FlowTotals totals() const {
    settle();
    FlowSums all = levels_.front()->sums();
    for (std::size_t l = 1; l < levels_.size(); ++l) all.add(levels_[l]->sums());
    return all.over_ranks(comm_);
  }
  /// Returns this rank's share of the force and torque (about the wall's position) of the fluid on a wall in
  /// the last step, in lbm::link_quantum; `wall` counts the rows of walls. Zero before the first step.
  std::array<std::int64_t, 6> wall_load(std::size_t wall) const {
    return wall < wall_loads_.size() ? wall_loads_[wall] : std::array<std::int64_t, 6>{};
  }
  /// Returns the momentum that added and removed bodies brought to the fluid and to the impulse debts on this
  /// rank since the flow was made: that of the fluid they replaced or that replaced them.
  const rigid::FixedVec3& momentum_brought() const { return brought_; }
  /// Returns the mass, in lbm::mass_quantum, that cells of this rank took from the fluid in all steps because
  /// they turned solid or fluid without a fluid neighbour (refill.hpp).
  rigid::FixedSum mass_taken() const { return mass_taken_; }
  const MappingCounts& mapping() const { return mapping_; }  // of the last step, this rank

  // ---- the passes call these ----
  void set_mapping(const MappingCounts& counts) { mapping_ = counts; }
  void take_mass(rigid::FixedSum quanta) { mass_taken_ += quanta; }
  void bring(const rigid::Vec3& momentum) { brought_.add(momentum); }
  /// Completes the sums of the last step (throws ForceOutOfRange as above).
  void begin_pass() { settle(); }
  /// Starts the sums that the next step completes.
  void end_step(const LinkOutcome& links) {
    out_of_range_ = links.out_of_range;
    wall_loads_ = links.wall_loads;
    brought_.add(links.debts_begun);
    sums_.start(comm_, {links.out_of_range != LinkOutcome::nobody});
  }
  /// Continues from an earlier account, of this run or another.
  void set_mass_taken(rigid::FixedSum quanta) { mass_taken_ = quanta; }
  void take_over(const FlowAccount& other) {
    other.settle();
    brought_ = other.brought_, mass_taken_ = other.mass_taken_;
  }

 private:
  /// The sums over ranks that a step starts and the next one completes.
  struct StepSums {
    std::int64_t ranks_out_of_range;  // ranks with a body whose sums are
  };
  /// Completes the sums of the last step.
  void settle() const {
    if (sums_.under_way() && sums_.finish().ranks_out_of_range > 0)
      throw ForceOutOfRange(parallel::least_over_ranks(comm_, out_of_range_));
  }

  std::vector<const FluidFields*> levels_;
  MPI_Comm comm_;
  MappingCounts mapping_;
  rigid::FixedVec3 brought_;
  rigid::FixedSum mass_taken_ = 0;
  std::vector<std::array<std::int64_t, 6>> wall_loads_;
  rigid::BodyId out_of_range_ = LinkOutcome::nobody;  // on this rank, in the last step
  mutable parallel::PendingSums<StepSums> sums_;      // completed by every function that reads them
};

}  // namespace silt::coupler

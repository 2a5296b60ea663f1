#pragma once
// The account of the fluid from step to step: its mass and momentum, what bodies did to them, and whether a
// force was out of range. What the ranks sum of a step is started at its end and settled when it is asked
// for.
#include <mpi.h>

#include <array>
#include <cstdint>
#include <vector>

#include "coupler/fluid_fields.hpp"
#include "coupler/forces/fluid_forces.hpp"
#include "parallel/pending_sums.hpp"
#include "rigid/math/exact_sum.hpp"

namespace silt::coupler {

/// Cells that changed sides on this rank in the last mapping (ghost cells not counted), and cut links held.
struct MappingCounts {
  std::uint64_t covered = 0, uncovered = 0, links = 0;
};

class FlowAccount {
 public:
  FlowAccount(const FluidFields& finest, MPI_Comm comm) : levels_{&finest}, comm_(comm) {}
  void add_level(const FluidFields& coarser) { levels_.push_back(&coarser); }

  // ---- asked between steps ----
  /// Collective; ForceOutOfRange, on every rank alike, if a body's sums were out of range in the last step.
  /// The cells have to be complete: Flow::totals sees to that.
  FlowTotals totals() const;
  /// This rank's share of the force and torque of the fluid on a wall in the last step (`wall` counts the
  /// walls' rows), the torque about its position, in lbm::link_quantum. Zero before the first step.
  std::array<std::int64_t, 6> wall_load(std::size_t wall) const {
    return wall < wall_loads_.size() ? wall_loads_[wall] : std::array<std::int64_t, 6>{};
  }
  /// Returns the momentum that bodies that came and went brought to the fluid and the impulse debts, of this
  /// rank, in all steps since the flow was made: by the fluid they took the place of, and that which took
  /// theirs.
  const rigid::FixedVec3& momentum_brought() const { return brought_; }
  /// Returns the mass, in lbm::mass_quantum, that this rank's cells took from the fluid because they changed
  /// sides where no neighbour was fluid (refill.hpp), in all steps.
  rigid::FixedSum mass_taken() const { return mass_taken_; }
  const MappingCounts& mapping() const { return mapping_; }  // of the last step, this rank

  // ---- the passes call these ----
  void set_mapping(const MappingCounts& counts) { mapping_ = counts; }
  void take_mass(rigid::FixedSum quanta) { mass_taken_ += quanta; }
  void bring(const rigid::Vec3& momentum) { brought_.add(momentum); }
  /// Begins a pass with what the last step left under way (ForceOutOfRange as above).
  void begin_pass() { settle(); }
  /// Starts the sums that the next step begins with.
  void end_step(const LinkOutcome&);
  /// Goes on from an earlier account, of this program or another.
  void set_mass_taken(rigid::FixedSum quanta) { mass_taken_ = quanta; }
  void take_over(const FlowAccount& other) {
    other.settle();
    brought_ = other.brought_, mass_taken_ = other.mass_taken_;
  }

 private:
  /// The step leaves this, summed over the ranks, for the next one to begin with.
  struct StepSums {
    std::int64_t ranks_out_of_range;  // that have a body whose sums are
  };
  /// Takes what the last step left under way.
  void settle() const;

  std::vector<const FluidFields*> levels_;
  MPI_Comm comm_;
  MappingCounts mapping_;
  rigid::FixedVec3 brought_;
  rigid::FixedSum mass_taken_ = 0;
  std::vector<std::array<std::int64_t, 6>> wall_loads_;
  rigid::BodyId out_of_range_ = LinkOutcome::nobody;  // of this rank, in the last step
  mutable parallel::PendingSums<StepSums> sums_;      // settled whenever something is asked for
};

}  // namespace silt::coupler

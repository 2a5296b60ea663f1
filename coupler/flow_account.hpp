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
#include "parallel/sums_under_way.hpp"
#include "rigid/math/exact_sum.hpp"

namespace silt::coupler {

struct FluidMass;

/// The correction remembers this between steps, alike on every rank; masses in lbm::mass_quantum, in 128
/// bits: those of 1e12 cells a thousandth off are 1e9, where 64 bits end at 8e6.
struct MassCorrectionState {
  rigid::FixedSum surplus = 0;  // sum of the density deviations of all fluid cells; 0 without a correction
  std::int64_t fluid_cells = 0;
  rigid::FixedSum link_gain = 0;  // through links in the last step, which is what the next one will bring
  std::int64_t steps = 0;         // since the simulation began
};

/// The mass correction. Interpolated walls, and cells that change sides, do not conserve the mass of the
/// fluid. The mass that is known to have been gained is taken out of all cells alike (method.md, equations 46
/// and 47).
class MassCorrection {
 public:
  const MassCorrectionState& state() const { return state_; }
  void set_state(const MassCorrectionState& state) { state_ = state; }

  /// Begins a step: takes the surplus out of the account, with as much as links gained in the last step, and
  /// returns the density that every cell is to be given for it. Where the coarsest cells take so many steps
  /// for one of theirs, this is done when theirs begins, and every step of it gives its share.
  double take_surplus(int steps_of_coarsest);
  /// A body has left a cell of this rank (1) or covered it (-1): the fluid has gained or lost what is in it.
  /// Counted when the step ends.
  void gain_cells(int cells, double density_deviation);
  /// The gain of all ranks in a step, or of one of them: mass through links and by cells that changed sides,
  /// and cells.
  struct Gain {
    rigid::FixedSum link_mass = 0, cell_mass = 0;
    std::int64_t cells = 0;
  };
  /// Returns what this rank gained in the step that ends, and begins to count again from 0.
  Gain take_gain(std::int64_t link_mass);
  /// Says whether the fluid is to be counted when the step at hand ends.
  bool recount_is_due() const;
  /// Ends a step with what all ranks gained in it.
  void end_step(const Gain& of_all);
  /// Sets the account to what there is. Populations in single precision round, so what is known differs from
  /// it by some 1e-13 a cell and step.
  void recount(const FluidMass&);

 private:
  MassCorrectionState state_;
  double source_ = 0;                // density added to every cell in a step
  rigid::FixedSum mass_gained_ = 0;  // this rank's in this step, by cells that changed sides
  std::int64_t cells_gained_ = 0;
};

/// Cells that changed sides on this rank in the last mapping (ghost cells not counted), and cut links held.
struct MappingCounts {
  std::uint64_t covered = 0, uncovered = 0, links = 0;
};

class FlowAccount {
 public:
  FlowAccount(const FluidFields& finest, MPI_Comm comm, bool corrects_mass)
      : levels_{&finest}, comm_(comm), corrects_mass_(corrects_mass) {}
  void add_level(const FluidFields& coarser) { levels_.push_back(&coarser); }

  // ---- asked between steps ----
  /// Collective; ForceOutOfRange, on every rank alike, if a body's sums were out of range in the last step.
  FlowTotals totals() const;
  const MassCorrectionState& mass_correction() const;  // the same
  /// This rank's share of the force and torque of the fluid on a wall in the last step (`wall` counts the
  /// walls' rows), the torque about its position, in lbm::link_quantum. Zero before the first step.
  std::array<std::int64_t, 6> wall_load(std::size_t wall) const {
    return wall < wall_loads_.size() ? wall_loads_[wall] : std::array<std::int64_t, 6>{};
  }
  /// Returns the momentum that bodies that came and went brought to the fluid and the impulse debts, of this
  /// rank, in all steps since the flow was made: by the fluid they took the place of, and that which took
  /// theirs.
  const rigid::FixedVec3& momentum_brought() const { return brought_; }
  const MappingCounts& mapping() const { return mapping_; }  // of the last step, this rank

  // ---- the passes call these ----
  bool corrects_mass() const { return corrects_mass_; }
  void set_mapping(const MappingCounts& counts) { mapping_ = counts; }
  /// The fluid has gained (1) or lost (-1) a cell of this rank.
  void gain_cell(int cells, double density_deviation) {
    if (corrects_mass_) correction_.gain_cells(cells, density_deviation);
  }
  void bring(const rigid::Vec3& momentum) { brought_.add(momentum); }
  /// Begins a pass with what the last step left under way (ForceOutOfRange as above); returns the density
  /// that every cell is to be given.
  double begin_pass();
  /// Starts the sums that the next step begins with.
  void end_step(const LinkOutcome&);
  /// Collective: sets the account of the mass to what there is.
  void recount();
  /// Goes on from an earlier account, of this program or another.
  void set_mass_correction(const MassCorrectionState& state) { correction_.set_state(state); }
  void take_over(const FlowAccount& other) {
    brought_ = other.brought_;
    set_mass_correction(other.mass_correction());
  }

 private:
  /// The step leaves this, summed over the ranks, for the next one to begin with.
  struct StepSums {
    std::int64_t ranks_out_of_range;  // that have a body whose sums are
    std::int64_t cells_gained;
    parallel::WideSum link_mass, cell_mass;  // gained
    struct Recount {                         // of all fluid, in some steps
      std::int64_t ranks = 0, cells = 0;
      parallel::WideSum quanta;
      Recount() = default;
      Recount(const FluidMass& m) : ranks(1), cells(std::int64_t(m.cells)), quanta(m.mass) {}
      FluidMass mass() const { return {std::uint64_t(cells), quanta.value()}; }
    } recount;
  };
  void settle() const;
  FluidMass mass() const;

  std::vector<const FluidFields*> levels_;
  MPI_Comm comm_;
  bool corrects_mass_;
  MappingCounts mapping_;
  rigid::FixedVec3 brought_;
  std::vector<std::array<std::int64_t, 6>> wall_loads_;
  rigid::BodyId out_of_range_ = LinkOutcome::nobody;  // of this rank, in the last step
  // settled whenever one of them is asked for
  mutable MassCorrection correction_;
  mutable parallel::SumsUnderWay<StepSums> sums_;
};

}  // namespace silt::coupler

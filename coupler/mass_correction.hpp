#pragma once
// The mass correction. Interpolated walls, and cells that change sides, do not conserve the mass of the
// fluid. What is known to have been gained is taken out of all cells alike (method.md, equations 46 and 47).
#include <cstdint>

#include "rigid/math/fixed_point.hpp"

namespace silt::coupler {

struct FluidMass;

/// What the correction remembers between steps; masses in lbm::mass_quantum, in 128 bits: those of 1e12 cells
/// a thousandth off are 1e9, where 64 bits end at 8e6. The same on every rank.
struct MassCorrectionState {
  rigid::FixedSum surplus = 0;  // sum of the density deviations of all fluid cells; 0 without a correction
  std::int64_t fluid_cells = 0;
  rigid::FixedSum link_gain = 0;  // through links in the last step, which is what the next one will bring
  std::int64_t steps = 0;         // since the simulation began
};

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
  /// What all ranks gained in a step, or one of them: mass through links and by cells that changed sides, and
  /// cells.
  struct Gain {
    rigid::FixedSum link_mass = 0, cell_mass = 0;
    std::int64_t cells = 0;
  };
  /// Returns what this rank gained in the step that ends, and begins to count anew.
  Gain take_gain(std::int64_t link_mass);
  /// Whether the fluid is to be counted when the step at hand ends.
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

}  // namespace silt::coupler

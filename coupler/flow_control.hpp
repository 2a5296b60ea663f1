#pragma once
// The control of the body force by which the fluid of a periodic domain flows as fast as it is to
// (method.md, equation 48). No step waits for a sum: what a look starts is used at the next one.
#include <mpi.h>

#include <cstdint>

#include "coupler/flow_totals.hpp"
#include "coupler/spec/fluid_spec.hpp"
#include "parallel/pending_sums.hpp"

namespace silt::coupler {

class FlowControl {
 public:
  static constexpr std::int64_t interval = 16;  // steps between two looks

  /// The control knows this at a look and until the next: the force then and before, the mean velocity then
  /// and at the look before.
  struct State {
    rigid::Vec3 force, force_before, velocity = rigid::Vec3::Zero(), velocity_before = rigid::Vec3::Zero();
  };

  /// `cells`: all of the domain.
  FlowControl(const FluidSpec&, double cells, MPI_Comm);

  bool is_due(std::int64_t step) const { return step % interval == 0 && step != looked_at_; }
  /// Takes what came of the last look, and starts the sums of this one; collective, before the step that
  /// follows `step`. The fluid feels `force()` from then on.
  void look(std::int64_t step, const FlowSums& here);
  /// Returns the controlled components of the force, and of another the rest.
  rigid::Vec3 force(const rigid::Vec3& given) const;

  /// Collective: waits for the sums under way.
  const State& state();
  /// Goes on from a state after so many steps.
  void set_state(const State& state, std::int64_t step) { state_ = state, looked_at_ = step; }
  std::int64_t looked_at() const { return looked_at_; }

 private:
  struct Sums {
    std::array<parallel::WideSum, 3> momentum;
    std::uint64_t cells = 0;
  };
  void settle();

  rigid::Vec3 wanted_;
  double cells_;
  MPI_Comm comm_;
  State state_;
  std::int64_t looked_at_ = -1;
  bool pending_ = false;
  parallel::PendingSums<Sums> sums_;
};

}  // namespace silt::coupler

#pragma once
// Controls the body force of a periodic domain to reach a superficial velocity (method.md, equation 48). No
// step waits for a sum: the sums started at one look are used at the next.
#include <mpi.h>

#include <cstdint>
#include <optional>

#include "coupler/flow_totals.hpp"
#include "coupler/spec/flow_spec.hpp"
#include "parallel/pending_sums.hpp"

namespace silt::coupler {

class FlowControl {
 public:
  static constexpr std::int64_t interval = 16;  // steps between two looks

  /// The state between two looks: the present force and the one before, and the mean velocity at the last
  /// look and the one before.
  struct State {
    rigid::Vec3 force, force_before, velocity = rigid::Vec3::Zero(), velocity_before = rigid::Vec3::Zero();
  };

  /// `cells` is the number of cells of the domain.
  FlowControl(const FluidSpec&, double cells, MPI_Comm);

  bool is_due(std::int64_t step) const { return step % interval == 0 && step != looked_at_; }
  /// Updates the force from the sums of the last look and starts new sums. Call before the step after `step`;
  /// the fluid then needs the new force(). Collective.
  void look(std::int64_t step, const FlowSums& here);
  /// Returns `given` with the controlled components replaced.
  rigid::Vec3 force(const rigid::Vec3& given) const;

  /// Completes the sums under way. Collective.
  const State& state();
  /// Continues from a state; `step` is the number of steps done.
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

/// What drives the fluid: its body force and the sides of the domain, over time.
struct FlowDrive {
  FlowDrive(const FlowSpec&, MPI_Comm);
  /// Returns the body force at a time; none if it never changes.
  std::optional<rigid::Vec3> force_at(double time) const;

  rigid::Vec3 body_force;
  rigid::OverTime over_time;  // of the body force
  std::array<BoundarySpec, 6> sides;
  bool pushes_bodies;                  // stands for a pressure gradient
  std::optional<FlowControl> control;  // of a superficial velocity
};

}  // namespace silt::coupler

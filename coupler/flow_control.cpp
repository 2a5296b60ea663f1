#include "coupler/flow_control.hpp"

namespace silt::coupler {

using rigid::Vec3;

FlowControl::FlowControl(const FluidSpec& fluid, double cells, MPI_Comm comm)
    : wanted_(fluid.superficial_velocity),
      cells_(cells),
      comm_(comm),
      state_{fluid.body_force, fluid.body_force} {}

void FlowControl::look(std::int64_t step, const FlowSums& here) {
  constexpr double intervals = 4;  // in which a difference decays: stable at any resistance (method.md)
  settle();
  if (step > 0) {
    if (step == interval) state_.velocity_before = state_.velocity;  // there was only one look so far
    const Vec3 gain = (state_.velocity - state_.velocity_before) / double(interval);
    const Vec3 lacking = (wanted_ - state_.velocity) / (intervals * double(interval));
    const Vec3 next = state_.force_before - gain + lacking;
    state_.force_before = state_.force;
    state_.force = next;
  }
  sums_.start(comm_, {here.momentum(), here.cells()});
  pending_ = true;
  looked_at_ = step;
}

Vec3 FlowControl::force(const Vec3& given) const {
  return (wanted_.array() != 0).select(state_.force, given);
}

const FlowControl::State& FlowControl::state() {
  settle();
  return state_;
}

/// Computes the velocity of the last look, with half of the present force.
void FlowControl::settle() {
  if (!pending_) return;
  pending_ = false;
  const Sums& all = sums_.finish();
  state_.velocity_before = state_.velocity;
  for (int d = 0; d < 3; ++d)
    state_.velocity[d] = (double(all.momentum[d].value()) * lbm::CellTotals::momentum_quantum +
                          0.5 * double(all.cells) * state_.force[d]) /
                         cells_;
}

FlowDrive::FlowDrive(const FlowSpec& spec, MPI_Comm comm)
    : body_force(spec.fluid->body_force),
      over_time(spec.fluid->body_force_over_time),
      sides(spec.boundary),
      pushes_bodies(spec.fluid->body_force_on_bodies && spec.fluid->has_body_force()) {
  if (!spec.fluid->superficial_velocity.isZero(0)) control.emplace(*spec.fluid, spec.volume(), comm);
}

std::optional<Vec3> FlowDrive::force_at(double time) const {
  if (!control && !over_time.varies()) return {};
  const Vec3 given = over_time.at(time) * body_force;
  return control ? control->force(given) : given;
}

}  // namespace silt::coupler

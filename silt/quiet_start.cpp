
#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <vector>

#include "adapters/automatic/collision_factory.hpp"
#include "coupler/coupled_step.hpp"
#include "coupler/exchange/coupling_state.hpp"
#include "lbm/fluid.hpp"
#include "silt/case/case.hpp"
#include "silt/scene.hpp"

namespace silt {

using rigid::Vec3;

namespace {

/// The scene with bodies held in place, whose velocities are only used to compute forces.
class HeldScene final : rigid::StepObserver {
 public:
  explicit HeldScene(Scene& scene) : scene_(scene), start_(scene.bodies) {
    scene_.flow->hold_bodies(true);
    if (scene_.rigid_step) {
      const ContactSpec& contacts = scene_.setup.contacts;
      rigid_step_.emplace(scene_.world, *scene_.contacts.backend, *scene_.contacts.resolver, *scene_.exchange,
                          adapters::make_broad_phase("auto", contacts.backend));
      rigid_step_->hold_poses();
      rigid_step_->set_observer(*this);
    }
    stop_bodies();
  }

  void advance(std::int64_t steps) {
    coupler::SceneParts parts = scene_.parts();
    parts.rigid_step = rigid_step_ ? &*rigid_step_ : nullptr;
    coupler::CoupledStep step(parts);
    for (; steps > 0; --steps) {
      step(scene_.bodies, {});
      forget_forces();
      if (scene_.springs) scene_.springs->share(scene_.bodies);
    }
  }

  /// Sets all velocities to zero and the temperature to that at the start, and keeps the pressure of the
  /// fluid.
  void come_to_rest() {
    for (int level = 0; level < scene_.flow->levels(); ++level) {
      coupler::FluidFields& fields = scene_.flow->fields(level);
      for (int b = 0; b < fields.blocks(); ++b) stop(fields, b);
      coupler::set_initial_temperature(scene_.setup, fields);
    }
    stop_bodies();
    if (scene_.springs) scene_.springs->start(scene_.bodies);
  }

  /// Restores the bodies. Copies get velocities from their owners; their other columns are those at the
  /// start.
  void give_back() {
    rigid::BodySet& bodies = scene_.bodies;
    for (std::size_t row = 0; row < start_.owned; ++row) {
      bodies.assign(row, start_.record(row));
      bodies.stored_impulses[row] = start_.stored_impulses[row];
    }
    for (std::size_t row = start_.owned; row < bodies.first_wall(); ++row) {
      coupler::CouplingState& copy = coupler::coupling_of(bodies, row);
      copy.foreseen_change = {}, copy.mass_owed = {}, copy.heat_owed = {};
      if (const auto& heat = scene_.setup.heat)
        copy.temperature.numbers[0] = heat->at_start(bodies.kind[row]);
    }
    for (std::size_t wall = 0; wall < start_.walls; ++wall)
      bodies.assign(bodies.first_wall() + wall, start_.record(start_.first_wall() + wall));
    forget_forces();
    scene_.exchange->relocate(bodies);
    if (scene_.springs) scene_.springs->share(bodies);
    scene_.flow->hold_bodies(false);
  }

 private:
  /// Returns the force on a cell of fluid of the initial temperature.
  std::array<double, 3> force_on(const coupler::FluidFields& fields) const {
    std::array<double, 3> force = fields.spec().force;
    if (const auto& heat = scene_.setup.heat)
      for (int d = 0; d < 3; ++d) force[d] += fields.width() * heat->initial * heat->buoyancy[d];
    return force;
  }
  void stop(coupler::FluidFields& fields, int b) const {
    constexpr int directions = lbm::D3Q19::directions;
    const std::array<double, 3> force = force_on(fields);
    std::array<double, directions> push;
    for (int i = 0; i < directions; ++i) push[i] = lbm::half_push(force, i);
    coupler::change_populations(fields, b, directions, [&](lbm::Int3, std::vector<double>& g) {
      const double density = std::accumulate(g.begin(), g.end(), 0.);
      for (int i = 0; i < directions; ++i) g[i] = lbm::D3Q19::w(i) * density - push[i];
    });
  }
  void stop_bodies() {
    rigid::BodySet& bodies = scene_.bodies;
    for (std::size_t row = 0; row < bodies.size(); ++row)
      bodies.set_velocity(row, Vec3::Zero(), Vec3::Zero());
  }
  void forget_forces() {
    std::ranges::fill(scene_.bodies.force, rigid::FixedVec3{});
    std::ranges::fill(scene_.bodies.torque, rigid::FixedVec3{});
  }

  void before_drift(rigid::BodySet&) override {}
  bool wants_contact_impulses() const override { return true; }
  void contact_impulse(rigid::BodySet& bodies, std::size_t row, const Vec3& impulse,
                       const Vec3& angular_impulse) override {
    coupler::add_contact_load(bodies, row, impulse, angular_impulse);
  }

  Scene& scene_;
  const rigid::BodySet start_;
  std::optional<rigid::RigidStep> rigid_step_;  // its own, as that of the scene must not begin
};

}  // namespace

void start_quietly(Scene& scene) {
  constexpr std::int64_t least = 16;  // steps of the coarsest cells, in which sound passes a body
  const std::int64_t stride = scene.setup.coarsening ? scene.setup.coarsening->stride() : 1;
  HeldScene held(scene);
  for (std::int64_t left = quiet_start_steps(scene.setup) / stride; left > 0;) {
    const std::int64_t interval = left > least ? (left + 1) / 2 : left;
    held.advance(interval * stride);
    held.come_to_rest();
    left -= interval;
  }
  held.give_back();
}

}  // namespace silt

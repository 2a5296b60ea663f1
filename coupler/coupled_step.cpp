#include "coupler/coupled_step.hpp"

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/forces/springs.hpp"
#include "parallel/traffic.hpp"

namespace silt::coupler {

CoupledStep::CoupledStep(const SceneParts& scene)
    : scene_(scene), clock_([] { return parallel::traffic(); }) {}

rigid::RigidStepReport CoupledStep::operator()(rigid::BodySet& bodies, const BodyChanges& changes) {
  if (scene_.springs) scene_.springs->add_forces(bodies);
  if (Flow* const flow = scene_.flow) {
    // Lines 1 and 2-4. The paper's line 1 sends densities around every body; here only moments around
    // uncovered cells are sent, after the bodies are mapped.
    if (scene_.surfaces) clock_.timed(Stage::object_mapping, [&] { flow->map_bodies(bodies, changes); });
    // Lines 6-8, and lines 9-11 for links within a block, whose populations are still cached.
    clock_.timed(Stage::stream_collide, [&] { flow->stream_collide(clock_); });
    // Line 5. Populations stream in place, so they are exchanged after the pass instead of before it.
    clock_.timed(Stage::lbm_communication, [&] { flow->communicate(); });
    // Lines 9-11 for all other links, and the forces on the bodies.
    if (scene_.surfaces) {
      clock_.timed(Stage::force_evaluation, [&] { flow->evaluate_forces(bodies); });
      store_loads(bodies);
      if (scene_.springs) scene_.springs->subtract_from_loads(bodies);
      clear_contact_loads(bodies);  // the flow has used them
    }
  }
  // Line 12: the physics engine, Algorithm 1.
  if (!scene_.rigid_step) return {};
  return scene_.rigid_step->advance(bodies, scene_.substeps);
}

StageSeconds CoupledStep::seconds() const {
  return with_bodies(clock_.seconds(), [](const rigid::RigidClock& clock) { return clock.seconds(); });
}

StageTraffic CoupledStep::traffic() const {
  return with_bodies(clock_.readings(), [](const rigid::RigidClock& clock) { return clock.readings(); });
}

template <class Stages, class Of>
Stages CoupledStep::with_bodies(Stages all, Of&& of) const {
  if (!scene_.rigid_step) return all;
  using enum rigid::RigidStage;
  const auto bodies = of(scene_.rigid_step->clock());
  all[int(Stage::integrate)] = bodies[int(integrate)];
  all[int(Stage::collision_detection)] = bodies[int(collision_detection)];
  all[int(Stage::contact_response)] = bodies[int(contact_response)];
  all[int(Stage::body_synchronisation)] = bodies[int(synchronisation)];
  return all;
}

}  // namespace silt::coupler

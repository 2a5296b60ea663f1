#include "coupler/coupled_step.hpp"

#include <chrono>

namespace silt::coupler {

namespace {
/// Adds the time since the last lap to a stage.
class Laps {
 public:
  explicit Laps(StageSeconds& seconds) : seconds_(seconds) {}
  void end(Stage stage) {
    const auto now = std::chrono::steady_clock::now();
    seconds_[int(stage)] += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }
  /// Time that was counted for one stage belongs to another.
  void move(Stage from, Stage to, double seconds) {
    seconds_[int(from)] -= seconds, seconds_[int(to)] += seconds;
  }

 private:
  StageSeconds& seconds_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};
}  // namespace

CoupledStep::CoupledStep(const SceneParts& scene) : scene_(scene) {}

rigid::RigidStepReport CoupledStep::operator()(rigid::BodySet& bodies) {
  Laps laps(seconds_);
  if (scene_.flow) {
    if (scene_.surfaces) {
      scene_.flow->map_bodies(bodies);  // Algorithm 2, line 1: object mapping
      laps.end(Stage::object_mapping);
    }
    scene_.flow->stream_collide(scene_.gravity);  // line 2, and on the way what most surfaces return
    laps.end(Stage::stream_collide);
    laps.move(Stage::stream_collide, Stage::force_evaluation, scene_.flow->take_link_seconds());
    scene_.flow->communicate();
    laps.end(Stage::lbm_communication);
    if (scene_.surfaces) {
      scene_.flow->evaluate_forces(bodies, scene_.gravity);  // line 3: what surfaces return, forces on bodies
      if (scene_.forces_seen) scene_.forces_seen(bodies);
      laps.end(Stage::force_evaluation);
    }
  }
  rigid::RigidStepReport report;
  if (scene_.rigid_step) {
    report = scene_.rigid_step->advance(bodies, scene_.substeps);  // line 4: the physics engine, Algorithm 1
    const rigid::StageClock& parts = report.seconds;
    seconds_[int(Stage::integrate)] += parts.integrate;
    seconds_[int(Stage::collision_detection)] += parts.collision_detection;
    seconds_[int(Stage::contact_response)] += parts.contact_response;
    seconds_[int(Stage::body_synchronisation)] += parts.synchronisation;
  }
  return report;
}

}  // namespace silt::coupler

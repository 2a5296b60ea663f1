#pragma once
// One step of fluid and bodies: Algorithm 2 of Goetz et al., SC10.
#include <array>
#include <functional>
#include <string_view>

#include "coupler/flow.hpp"
#include "rigid/rigid_step.hpp"

namespace silt::coupler {

/// The stages of the paper's Figure 7; the last four are the parts of its "physics engine".
enum class Stage {
  object_mapping,
  lbm_communication,
  stream_collide,
  force_evaluation,
  integrate,
  collision_detection,
  contact_response,
  body_synchronisation,
  count
};
inline constexpr std::array<std::string_view, int(Stage::count)> stage_names = {
    "object mapping", "LBM communication",   "stream collide",   "force evaluation",
    "integrate",      "collision detection", "contact response", "body synchronisation"};

using StageSeconds = std::array<double, int(Stage::count)>;

/// What a scene consists of; a part that is absent is null, and its passes do not exist.
struct SceneParts {
  Flow* flow = nullptr;
  rigid::RigidStep* rigid_step = nullptr;  // null: no body moves
  int substeps = 1;
  rigid::Vec3 gravity = rigid::Vec3::Zero();
  bool surfaces = false;  // of bodies, fixed ones included, or of curved walls
  /// Called when the fluid's forces stand in the rows' accumulators and nothing has consumed them; may be
  /// empty.
  std::function<void(const rigid::BodySet&)> forces_seen;
};

class CoupledStep {
 public:
  explicit CoupledStep(const SceneParts&);
  /// Advances everything by one step; returns what the bodies did.
  rigid::RigidStepReport operator()(rigid::BodySet&);
  const StageSeconds& seconds() const { return seconds_; }  // of all steps so far, this rank

 private:
  SceneParts scene_;
  StageSeconds seconds_{};
};

}  // namespace silt::coupler

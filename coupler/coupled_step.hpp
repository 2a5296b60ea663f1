#pragma once
// One step of fluid and bodies: Algorithm 2 of Goetz et al., SC10.
#include "coupler/flow.hpp"
#include "coupler/stages.hpp"
#include "rigid/rigid_step.hpp"

namespace silt::coupler {

class Springs;

/// The parts of a scene; a part that is absent is null, and its passes do not exist.
struct SceneParts {
  Flow* flow = nullptr;
  Springs* springs = nullptr;
  rigid::RigidStep* rigid_step = nullptr;  // null: no body moves
  int substeps = 1;
  bool surfaces = false;  // of bodies, fixed ones included, or of curved walls
};

class CoupledStep {
 public:
  explicit CoupledStep(const SceneParts&);
  /// Goes on with other parts; the seconds so far stay.
  void renew(const SceneParts& scene) { scene_ = scene; }
  /// Advances everything by one step; returns what the bodies did. The changes are those since the last step.
  rigid::RigidStepReport operator()(rigid::BodySet&, const BodyChanges&);
  /// Seconds of all steps so far, on this rank, by stage; and what it exchanged with others in them.
  StageSeconds seconds() const;
  StageTraffic traffic() const;

 private:
  /// The stages of the fluid with those of the bodies.
  template <class Stages, class Of>
  Stages with_bodies(Stages, Of&&) const;

  SceneParts scene_;
  StepClock clock_;  // of the fluid's stages
};

}  // namespace silt::coupler

#pragma once
// One step of fluid and bodies: Algorithm 2 of Goetz et al., SC10.
#include "coupler/flow.hpp"
#include "coupler/stages.hpp"
#include "rigid/rigid_step.hpp"

namespace silt::coupler {

class Springs;

/// The parts of a scene; the passes of an absent part (null) are left out.
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
  /// Continues with other parts; keeps the times measured so far.
  void renew(const SceneParts& scene) { scene_ = scene; }
  /// Advances the scene by one step; returns the report on the bodies. `changes`: those since the last step.
  rigid::RigidStepReport operator()(rigid::BodySet&, const BodyChanges&);
  /// Return the seconds and the traffic with other ranks, by stage, of all steps on this rank.
  StageSeconds seconds() const;
  StageTraffic traffic() const;

 private:
  /// Adds the stages of the bodies to those of the fluid.
  template <class Stages, class Of>
  Stages with_bodies(Stages, Of&&) const;

  SceneParts scene_;
  StepClock clock_;  // of the fluid's stages
};

}  // namespace silt::coupler

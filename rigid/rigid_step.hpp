#pragma once
// One step of the bodies: Algorithm 1 of Goetz et al., SC10.
#include "parallel/traffic.hpp"
#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"
#include "rigid/collision/collision_backend.hpp"
#include "rigid/collision/detect_contacts.hpp"
#include "rigid/math/stage_clock.hpp"
#include "rigid/math/types.hpp"
#include "rigid/response/contact_resolver.hpp"

namespace silt::rigid {

/// The stages of a step, named as in the paper.
enum class RigidStage { integrate, collision_detection, contact_response, synchronisation, count };
using RigidClock = StageClock<RigidStage, parallel::Traffic>;

struct RigidStepReport {
  ResolverStatistics resolver;
  std::uint64_t pairs = 0;                 // candidate pairs of the broad phase
  LubricationCounts lubrication;           // narrow gaps that this rank found
  std::uint64_t mixed_owner_contacts = 0;  // between bodies of different owners (0 on one rank)

  /// Adds the counts of a later sub-step; all counts but the resolver's replace the earlier ones.
  RigidStepReport& operator+=(const RigidStepReport& later) {
    resolver += later.resolver;
    pairs = later.pairs;
    lubrication = later.lubrication;
    mixed_owner_contacts = later.mixed_owner_contacts;
    return *this;
  }
};

/// Is notified of events within a sub-step.
class StepObserver {
 public:
  /// Is called once the velocities are final, before bodies move with them.
  virtual void before_drift(BodySet&) = 0;
  virtual bool wants_contact_impulses() const = 0;
  /// Returns whether other_impulses() shall include contacts between free bodies.
  virtual bool wants_all_impulses() const { return false; }
  /// Is called before before_drift, for each owned free body in contact, with the impulse and the angular
  /// impulse about its centre of mass of all its contacts, including lubrication films.
  virtual void contact_impulse(BodySet&, std::size_t row, const Vec3& impulse,
                               const Vec3& angular_impulse) = 0;

 protected:
  ~StepObserver() = default;
};

class RigidStep {
 public:
  RigidStep(const World&, CollisionBackend&, ContactResolver&, BodyExchange&,
            std::unique_ptr<BroadPhase> = std::make_unique<UniformGrid>());
  /// Advances all bodies by dt (1 / substeps of a fluid step), then clears forces and torques. The order is
  /// that of Algorithm 1, except that velocities are updated (lines 2-5) after line 13: rows change in the
  /// synchronisations, and detection uses the velocities before the update.
  RigidStepReport operator()(BodySet&, double dt);
  /// Advances all bodies by one fluid step in `substeps` equal parts, with constant forces and torques.
  RigidStepReport advance(BodySet&, int substeps);
  /// Marks the bodies as those of an earlier run. Without it the next step has no impulses to start from, and
  /// solves chains of contacts more exactly.
  void resume() { velocities_.start = false; }
  /// Keeps all poses constant from now on: contacts and forces change velocities only.
  void hold_poses() { holds_poses_ = true; }
  /// Sets the observer of every sub-step from now on.
  void set_observer(StepObserver& observer) { observer_ = &observer; }
  /// Returns the contacts of this rank's bodies in the last sub-step, sorted by key.
  const std::vector<Contact>& contacts() const { return contacts_; }
  /// Returns the impulses of the last sub-step that are not stored for the warm start; in the first step of a
  /// run without those of lubrication films against rolling.
  std::span<const OtherImpulse> other_impulses() const { return velocities_.other_impulses; }
  /// Returns the clock with the seconds of each stage, summed over all steps on this rank.
  const RigidClock& clock() const { return clock_; }

 private:
  const World& world_;
  CollisionBackend& backend_;
  ContactResolver& resolver_;
  BodyExchange& exchange_;
  RigidStepReport substep(BodySet&, double dt, bool last);
  void kick_before_contacts(BodySet&, double dt);
  void finish(BodySet&, double dt, bool last);
  void find_rows_in_contact(const BodySet&);
  void kick(BodySet&, std::size_t row, double dt) const;
  void apply_velocities(BodySet&, double dt);
  void apply_position_correction(BodySet&, double dt) const;

  StepObserver* observer_ = nullptr;
  RigidClock clock_;
  DetectContacts detect_contacts_;
  std::vector<Contact> contacts_;
  StepVelocities velocities_;
  bool holds_poses_ = false;
  bool forced_ = false;                   // some body has a force or torque in this sub-step
  std::vector<std::uint8_t> in_contact_;  // by row
};

// The half steps of Algorithm 1 (lines 2-5 and 21-22): force-free motion, with rotation by the implicit
// midpoint rule (method.md, M5 and M6).

/// Moves the first `rows` bodies over time h: free bodies with constant v and L, prescribed ones with
/// constant v and omega. Sets angular_velocity = I_W^-1 L at the new orientation. Fixed bodies stay.
void drift(BodySet&, std::size_t rows, double h);

/// Returns the orientation after a free rotation over time h with constant L_W. Public for tests.
Quat free_rotation(const Quat& orientation, const Mat3& inertia_B, const Vec3& angular_momentum_W, double h);

}  // namespace silt::rigid

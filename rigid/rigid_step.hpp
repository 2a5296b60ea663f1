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

/// RigidStage lists the paper's parts of the physics engine.
enum class RigidStage { integrate, collision_detection, contact_response, synchronisation, count };
using RigidClock = StageClock<RigidStage, parallel::Traffic>;

struct RigidStepReport {
  ResolverStatistics resolver;
  std::uint64_t pairs = 0;                 // candidate pairs of the broad phase
  LubricationCounts lubrication;           // contacts as narrow as that this rank found
  std::uint64_t mixed_owner_contacts = 0;  // between bodies that different ranks own (parallel only)

  /// Adds a later sub-step: its counts take the place of those before.
  RigidStepReport& operator+=(const RigidStepReport& later) {
    resolver += later.resolver;
    pairs = later.pairs;
    lubrication = later.lubrication;
    mixed_owner_contacts = later.mixed_owner_contacts;
    return *this;
  }
};

/// A StepObserver hears what happens within a sub-step.
class StepObserver {
 public:
  /// The velocities are final, and no body has moved by them.
  virtual void before_drift(BodySet&) = 0;
  virtual bool wants_contact_impulses() const = 0;
  /// Says whether other_impulses() is to have those between free bodies.
  virtual bool wants_all_impulses() const { return false; }
  /// Is called before that for each owned free body in contact, with the impulse and the angular impulse
  /// about its centre of mass that its contacts, films included, gave it.
  virtual void contact_impulse(BodySet&, std::size_t row, const Vec3& impulse,
                               const Vec3& angular_impulse) = 0;

 protected:
  ~StepObserver() = default;
};

class RigidStep {
 public:
  RigidStep(const World&, CollisionBackend&, ContactResolver&, BodyExchange&,
            std::unique_ptr<BroadPhase> = std::make_unique<UniformGrid>());
  /// Advances every body by dt (1 / substeps of a fluid step); forces are consumed and cleared. Keeps the
  /// order of Algorithm 1 but for the velocity half of lines 2-5, which waits until line 13 is done: rows
  /// change at the synchronisations, and detection works with the velocities before the kick.
  RigidStepReport operator()(BodySet&, double dt);
  /// Advances by a step of length 1 in `substeps` equal parts, the given forces held over all of them.
  RigidStepReport advance(BodySet&, int substeps);
  /// The bodies come from an earlier run: the next step is not their start, in which contacts of chains are
  /// solved more exactly since there is no impulse to begin with.
  void resume() { velocities_.start = false; }
  /// Bodies keep their poses from now on: contacts and forces change their velocities alone.
  void hold_poses() { holds_poses_ = true; }
  /// Sets the observer of every sub-step from now on.
  void set_observer(StepObserver& observer) { observer_ = &observer; }
  /// Returns the contacts of the last sub-step that this rank knows: of its bodies, sorted by key.
  const std::vector<Contact>& contacts() const { return contacts_; }
  /// Returns what contacts gave in the last sub-step besides the impulses that are remembered; of the first
  /// step of a run not what films did against rolling.
  std::span<const OtherImpulse> other_impulses() const { return velocities_.other_impulses; }
  /// Returns what tells the seconds of all steps so far, on this rank.
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
  void take_velocities(BodySet&, double dt);
  void take_position_correction(BodySet&, double dt) const;

  StepObserver* observer_ = nullptr;
  RigidClock clock_;
  DetectContacts detect_contacts_;
  std::vector<Contact> contacts_;
  StepVelocities velocities_;
  bool holds_poses_ = false;
  bool forced_ = false;                   // some body is, in this sub-step
  std::vector<std::uint8_t> in_contact_;  // by row
};

// The half steps of Algorithm 1 (lines 2-5 and 21-22): drift without force, rotation by the
// implicit midpoint rule (method.md, M5 and M6).

/// Moves the bodies of the first `rows` rows by h: free ones with constant v and L, prescribed ones with
/// constant v and omega. Leaves angular_velocity = I_W^-1 L at the new orientation. Fixed bodies stay.
void drift(BodySet&, std::size_t rows, double h);

/// Returns the orientation after a free rotation over h; L_W is constant. Exposed for tests.
Quat free_rotation(const Quat& orientation, const Mat3& inertia_B, const Vec3& angular_momentum_W, double h);

}  // namespace silt::rigid

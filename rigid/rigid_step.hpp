#pragma once
// One step of the bodies: Algorithm 1 of Goetz et al., SC10.
#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"
#include "rigid/collision/collision_backend.hpp"
#include "rigid/collision/detect_contacts.hpp"
#include "rigid/response/contact_resolver.hpp"

namespace silt::rigid {

struct RigidSeconds {  // seconds of the last step, by the paper's parts of the physics engine
  double integrate = 0, collision_detection = 0, contact_response = 0, synchronisation = 0;
};

struct RigidStepReport {
  ResolverStatistics resolver;
  std::uint64_t pairs = 0;                 // candidate pairs of the broad phase
  FilmCounts films;                        // contacts as narrow as that this rank found
  std::uint64_t mixed_owner_contacts = 0;  // between bodies that different ranks own (parallel only)
  RigidSeconds seconds;
};

class RigidStep {
 public:
  RigidStep(const World&, CollisionBackend&, ContactResolver&, BodyExchange&,
            std::unique_ptr<BroadPhase> = std::make_unique<UniformGrid>());
  /// Advances every body by dt (1 / substeps of a fluid step); forces are consumed and cleared. Keeps the
  /// order of Algorithm 1 but for the velocity half of lines 2-5, which waits until line 13 is done: rows
  /// change at the synchronisations, and detection works with the velocities before the kick.
  RigidStepReport operator()(BodySet&, double dt);
  /// The same for `substeps` equal parts of a step of length 1, the given forces held over all of them.
  RigidStepReport advance(BodySet&, int substeps);

 private:
  const World& world_;
  CollisionBackend& backend_;
  ContactResolver& resolver_;
  BodyExchange& exchange_;
  RigidStepReport after_forces(BodySet&, double dt, bool last);  // lines 2 to 23
  void find_rows_in_contact(const BodySet&);
  void first_kick(BodySet&, double dt);
  void kick(BodySet&, std::size_t row, double dt) const;
  void take_velocities(BodySet&, double dt);
  void take_position_correction(BodySet&, double dt) const;

  DetectContacts detect_contacts_;
  std::vector<Contact> contacts_;
  StepVelocities velocities_;
  bool forced_ = false;                   // some body is, in this sub-step
  std::vector<std::uint8_t> in_contact_;  // by row
};

}  // namespace silt::rigid

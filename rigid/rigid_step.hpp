#pragma once
// One step of the bodies: Algorithm 1 of Goetz et al., SC10.
#include "rigid/body_exchange.hpp"
#include "rigid/body_set.hpp"
#include "rigid/collision_backend.hpp"
#include "rigid/contact_resolver.hpp"

namespace silt::rigid {

struct Material {
  double restitution = 0, friction = 0;
};

/// What all ranks know alike: shapes, materials and laws. Tables of pairs are [i * materials + j], symmetric.
struct World {
  std::vector<Shape> shapes;
  std::vector<double> bounding_radii;        // one a shape
  std::vector<Material> materials;           // of pairs: materials.size() == material_count^2
  int material_count = 0;
  Vec3 gravity = Vec3::Zero();
  double contact_margin = 1.0;               // largest gap a speculative contact may have, lattice units

  const Material& pair(int i, int j) const { return materials[i * material_count + j]; }
};

struct StageClock {  // seconds of the last step, by the paper's parts of the physics engine
  double integrate = 0, collision_detection = 0, contact_response = 0, synchronisation = 0;
};

struct RigidStepReport {
  ResolverStatistics resolver;
  std::uint64_t pairs = 0;  // candidate pairs of the broad phase
  std::uint64_t mixed_owner_contacts = 0;  // between bodies that different ranks own (parallel only)
  StageClock seconds;
};

class RigidStep {
 public:
  RigidStep(const World&, CollisionBackend&, ContactResolver&, BodyExchange&);
  /// Advances every body by dt (1 / substeps of a fluid step); forces are consumed and cleared.
  RigidStepReport operator()(BodySet&, double dt);
  /// The same for `substeps` equal parts of a step of length 1, the given forces held over all of them.
  RigidStepReport advance(BodySet&, int substeps);

 private:
  const World& world_;
  CollisionBackend& backend_;
  ContactResolver& resolver_;
  BodyExchange& exchange_;
  std::vector<Contact> contacts_;
  StepVelocities velocities_;
};

}  // namespace silt::rigid

#pragma once
// Springs and dampers between bodies, or to points of the domain (method.md, equations 49, 50).
#include <mpi.h>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coupler/spec/flow_spec.hpp"
#include "parallel/pending_sums.hpp"
#include "rigid/bodies/body_exchange.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

/// The mobility of a body: square roots of its inverse mass along each axis and of its inverse inertia (W).
/// Zero for a fixed body, and along or about locked axes.
struct Yield {
  rigid::Vec3 along = rigid::Vec3::Zero();
  rigid::Mat3 about = rigid::Mat3::Zero();
};

/// A spring in the middle of a step.
struct SpringInStep {
  std::array<int, 2> bodies;        // indices in the set; -1: the domain
  std::array<rigid::Vec3, 2> arms;  // from the centres of mass, W
  rigid::Vec3 force;                // of the spring on its first end, reversed on the second
  rigid::Vec3 rate, gain;  // velocity of the second end relative to the first at the start of the step, and
                           // its change in the step by other forces than the set's
  rigid::Mat3 damping;     // positive semidefinite
};

/// Returns the force of each spring and damper on its first end, also where they have bodies in common
/// (method.md, equations 49 to 50b).
std::vector<rigid::Vec3> forces_of(std::span<const SpringInStep>, std::span<const Yield> bodies);

class Springs {
 public:
  /// The motions are those of the bodies 1, 2, ...
  Springs(std::span<const SpringSpec>, std::span<const rigid::Motion>, const rigid::Extent&, MPI_Comm);

  /// Initialises all bodies, or one whose velocity has been set, for a step in which only springs have acted.
  void start(rigid::BodySet&);
  static void start(rigid::BodySet&, std::size_t row);
  /// Starts the exchange of bodies connected by springs with all ranks. Collective, but does not wait; call
  /// before the first step and after each step.
  void share(const rigid::BodySet&);
  /// Adds the springs' forces of a step to this rank's bodies.
  void add_forces(rigid::BodySet&);
  /// Subtracts them from the stored loads of the fluid, which include all forces.
  void subtract_from_loads(rigid::BodySet&) const;

 private:
  /// Springs connected by free bodies, and their bodies.
  struct Set {
    std::vector<SpringSpec> springs;
    std::vector<rigid::BodyId> bodies;
  };
  struct Sprung {  // a body in the middle of the step
    rigid::Pose pose;
    rigid::Twist twist, gain;  // gain: change of the twist in a step by other forces than springs
    Yield yield;
  };
  SpringInStep in_step(const SpringSpec&, const Sprung& first, const Sprung& second) const;
  std::optional<Sprung> sprung(const rigid::BodySet&, rigid::BodyId) const;
  void add_forces(rigid::BodySet&, const Set&);
  void add(rigid::BodySet&, rigid::BodyId, const rigid::Vec3& force, const rigid::Vec3& arm);

  std::vector<Set> sets_;
  std::vector<rigid::BodyId> bodies_;  // with a spring, sorted
  rigid::Extent extent_;
  MPI_Comm comm_;
  std::vector<rigid::BodyId> shared_;      // with a spring to another body, sorted
  std::vector<std::int64_t> shared_bits_;  // the bits of their SharedBody
  parallel::PendingSums<std::vector<std::int64_t>> sums_;
};

}  // namespace silt::coupler

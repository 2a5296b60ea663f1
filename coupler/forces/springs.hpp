#pragma once
// Springs and dampers between bodies, or to points of the domain (method.md, equations 49, 50).
#include <mpi.h>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coupler/forces/spring_set.hpp"
#include "coupler/spec/spring_spec.hpp"
#include "parallel/pending_sums.hpp"
#include "rigid/bodies/body_exchange.hpp"

namespace silt::coupler {

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

#pragma once
// Springs and dampers between bodies, or between a body and a point of the domain (method.md, equations 49,
// 50).
#include <mpi.h>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coupler/forces/spring_set.hpp"
#include "coupler/spec/spring_spec.hpp"
#include "parallel/sums_under_way.hpp"
#include "rigid/bodies/body_exchange.hpp"

namespace silt::coupler {

class Springs {
 public:
  /// Motions: of the bodies 1, 2, ...
  Springs(std::span<const SpringSpec>, std::span<const rigid::Motion>, const rigid::Extent&, MPI_Comm);

  /// Begins with bodies that nothing but their springs will change; also one whose velocity has been set.
  void start(rigid::BodySet&);
  static void start(rigid::BodySet&, std::size_t row);
  /// Tells all ranks of the bodies that have springs between them. Collective, but waits for nobody; after
  /// each step, and before the first.
  void look(const rigid::BodySet&);
  /// Adds the forces of a step to the accumulators of this rank's bodies.
  void push(rigid::BodySet&);
  /// Takes them out of what has been noted of the fluid's, which counts all of the accumulators.
  void leave_out(rigid::BodySet&) const;

 private:
  /// Springs that share bodies which move, and their bodies.
  struct Set {
    std::vector<SpringSpec> springs;
    std::vector<rigid::BodyId> bodies;
  };
  struct Sprung {  // a body in the middle of the step
    rigid::Pose pose;
    rigid::Twist twist, gain;  // what else than springs changes the twist by in a step
    Yield yield;
  };
  SpringInStep in_step(const SpringSpec&, const Sprung& first, const Sprung& second) const;
  std::optional<Sprung> sprung(const rigid::BodySet&, rigid::BodyId) const;
  void push(rigid::BodySet&, const Set&);
  void add(rigid::BodySet&, rigid::BodyId, const rigid::Vec3& force, const rigid::Vec3& arm);

  std::vector<Set> sets_;
  std::vector<rigid::BodyId> bodies_;  // that have a spring, sorted
  rigid::Extent extent_;
  MPI_Comm comm_;
  std::vector<rigid::BodyId> shared_;  // that have a spring to another body, sorted
  std::vector<std::int64_t> told_;     // of each of them, the bits of a Told
  parallel::SumsUnderWay<std::vector<std::int64_t>> sums_;
};

}  // namespace silt::coupler

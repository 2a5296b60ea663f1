#pragma once
// Springs and dampers between bodies, or between a body and a point of the domain (method.md, equations 49,
// 50).
#include <mpi.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "coupler/case/case.hpp"
#include "parallel/sums_under_way.hpp"

namespace silt::coupler {

class Springs {
 public:
  Springs(const Case&, MPI_Comm);

  /// Tells all ranks where the bodies are that have springs between them. Collective, but waits for nobody;
  /// after each step, and before the first.
  void look(const rigid::BodySet&);
  /// Adds the forces of a step to the accumulators of this rank's bodies.
  void push(rigid::BodySet&);
  /// Takes them out of what has been noted of the fluid's.
  void leave_out(rigid::BodySet&) const;

 private:
  struct State {  // in the middle of the step
    rigid::Pose pose;
    rigid::Twist twist;
  };
  struct Push {
    std::size_t row;
    rigid::Vec3 force, torque;
  };
  std::optional<State> state(const rigid::BodySet&, rigid::BodyId) const;
  void add(rigid::BodySet&, rigid::BodyId, const rigid::Vec3& force, const rigid::Vec3& arm);
  void pull(rigid::BodySet&, const SpringSpec&);

  std::vector<SpringSpec> springs_;
  rigid::Extent extent_;
  MPI_Comm comm_;
  std::vector<rigid::BodyId> shared_;  // that have a spring to another body, sorted
  std::vector<std::int64_t> told_;     // of each of them, the bits of a Kinematics
  parallel::SumsUnderWay<std::vector<std::int64_t>> sums_;
  std::vector<Push> pushes_;  // of the step under way
};

}  // namespace silt::coupler

#pragma once
// Velocities of the fluid in the cells of a box and beside them, whichever rank has them.
#include <mpi.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "coupler/fluid_fields.hpp"

namespace silt::parallel {
class Messages;
}  // namespace silt::parallel

namespace silt::coupler {

class CellVelocities {
 public:
  /// How many cells beyond a block's face are known.
  static constexpr int reach = 2;

  /// Collective: ranks tell each other the velocities of the cells within reach of the faces of what their
  /// blocks have of the box [lower, upper).
  CellVelocities(const FluidFields&, MPI_Comm, lbm::Int3 lower, lbm::Int3 upper);

  /// Returns the velocity in a cell beyond a block of this rank, up to `reach` cells along an axis from one
  /// of the box and of the block; nothing where there is no fluid. Lattice units.
  std::optional<rigid::Vec3> at(int block, lbm::Int3 local_cell) const;

 private:
  struct Known {
    std::int64_t cell;
    std::int64_t is_fluid;
    double velocity[3];
  };
  void tell(int block, const lbm::BlockPlace& to, parallel::Messages&);
  std::int64_t index(lbm::Int3 cell) const;

  const FluidFields& fields_;
  lbm::CellBox box_;
  int rank_ = 0;
  std::vector<Known> known_;  // by cell
};

}  // namespace silt::coupler

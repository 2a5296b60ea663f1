#pragma once
// Velocities of the fluid in the cells of a box and beside them, whichever rank has them.
#include <mpi.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "coupler/flow.hpp"

namespace silt::parallel {
class Messages;
}  // namespace silt::parallel

namespace silt::coupler {

class CellVelocities {
 public:
  /// How many cells beyond a block's face are known.
  static constexpr int reach = 2;

  /// Collective: ranks tell each other the velocities of the cells within reach of the faces of what their
  /// blocks have of the box [lower, upper). Refers to the flow, whose state must stay as it is.
  CellVelocities(const Flow&, MPI_Comm, lbm::Int3 lower, lbm::Int3 upper);

  /// Returns the velocity in a cell of the box and of this rank's block, or up to `reach` cells from one
  /// along an axis; nothing where there is no fluid. Lattice units.
  std::optional<rigid::Vec3> at(int block, lbm::Int3 local_cell) const;

 private:
  struct Known {
    std::int64_t cell;
    std::int64_t is_fluid;
    double velocity[3];
  };
  lbm::CellBox in_box(const lbm::CellBox& block) const;
  template <class Visit>
  void for_cells_around(const lbm::CellBox&, Visit&&) const;
  void send(parallel::Messages&) const;
  std::int64_t index(lbm::Int3 cell) const;
  std::optional<rigid::Vec3> here(int block, lbm::Int3 local_cell) const;

  const Flow& flow_;
  lbm::Int3 lower_, upper_;
  int rank_ = 0;
  std::vector<Known> from_others_;  // by cell
};

}  // namespace silt::coupler

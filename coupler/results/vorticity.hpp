#pragma once
// The vorticity of the fluid, curl u, from differences of the velocities of cells.
#include <array>
#include <vector>

#include "coupler/results/cell_velocities.hpp"

namespace silt::coupler {

/// The velocities of the fluid in cells of a block and near them, made a plane at a time.
/// For who goes through the cells plane by plane: it keeps as many planes as are within reach of one.
class VelocitiesAround {
 public:
  /// Cells [first, last) of a block along x and y, and those within CellVelocities::reach of them: of other
  /// blocks as `others` knows them. Refers to both.
  VelocitiesAround(const FluidFields&, const CellVelocities& others, int block, lbm::Int3 first,
                   lbm::Int3 last);

  /// Returns the velocity in one of these cells, of the block's coordinates; nothing where there is no fluid.
  /// Lattice units.
  std::optional<rigid::Vec3> at(lbm::Int3 cell);

 private:
  using Plane = std::vector<std::optional<rigid::Vec3>>;
  static constexpr int kept = 2 * CellVelocities::reach + 1;
  void make(int z);

  const FluidFields& fields_;
  const CellVelocities& others_;
  int block_;
  lbm::Int3 low_, high_;  // cells [low, high) are made here
  std::array<Plane, kept> plane_;
  std::array<int, kept> height_;  // of the planes; -1: none yet
};

/// Returns the vorticity in a fluid cell, lattice units. Differences are central; beside what is not fluid
/// they are taken from the other side, exact for velocities that are quadratic along the axis where two cells
/// there are fluid, else of the first order; 0 between walls on both sides.
rigid::Vec3 vorticity(VelocitiesAround&, lbm::Int3 cell);

}  // namespace silt::coupler

#pragma once
// The derivatives of the fluid's velocity: the vorticity, curl u, from differences of the velocities of
// cells, whichever rank has them, and the strain rate, which the populations of a cell hold.
#include <mpi.h>

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "coupler/fluid_fields.hpp"
#include "coupler/spec/flow_spec.hpp"

namespace silt::parallel {
class Messages;
}  // namespace silt::parallel

namespace silt {

/// CellVelocities are the velocities of the fluid beside the blocks of this rank.
class CellVelocities {
 public:
  /// How many cells beyond a block's face are known.
  static constexpr int reach = 2;

  /// Collective: ranks tell each other the velocities of the cells within reach of the faces of what their
  /// blocks have of the box [lower, upper).
  CellVelocities(const coupler::FluidFields&, MPI_Comm, lbm::Int3 lower, lbm::Int3 upper);

  /// Returns the velocity in a cell beyond a block of this rank, up to `reach` cells along an axis from one
  /// of the box and of the block; nothing where there is no fluid, or another level.
  std::optional<rigid::Vec3> at(int block, lbm::Int3 local_cell) const;

 private:
  struct Known {
    std::int64_t cell;
    std::int64_t is_fluid;
    double velocity[3];
  };
  void tell(int block, const lbm::BlockPlace& to, parallel::Messages&);
  std::int64_t index(lbm::Int3 cell) const;

  const coupler::FluidFields& fields_;
  lbm::CellBox box_;
  int rank_ = 0;
  std::vector<Known> known_;  // by cell
};

/// The velocities of the fluid in cells of a block and near them, made a plane at a time.
/// For who goes through the cells plane by plane: it keeps as many planes as are within reach of one.
class VelocitiesAround {
 public:
  /// Cells [first, last) of a block along x and y, and those within CellVelocities::reach of them: of other
  /// blocks as `others` knows them. Refers to both.
  VelocitiesAround(const coupler::FluidFields&, const CellVelocities& others, int block, lbm::Int3 first,
                   lbm::Int3 last);

  /// Returns the velocity in one of these cells of the block; nothing where there is no fluid.
  std::optional<rigid::Vec3> at(lbm::Int3 cell);

 private:
  using Plane = std::vector<std::optional<rigid::Vec3>>;
  static constexpr int kept = 2 * CellVelocities::reach + 1;
  void make(int z);

  const coupler::FluidFields& fields_;
  const CellVelocities& others_;
  int block_;
  lbm::Int3 low_, high_;  // cells [low, high) are made here
  std::array<Plane, kept> plane_;
  std::array<int, kept> height_;  // of the planes; -1: none yet
};

/// Returns the vorticity in a fluid cell, in units of the cell's level. Differences are central; beside what
/// is not fluid, or of another level, they are taken from the other side, of the second order where two cells
/// there are fluid, else of the first; 0 between walls on both sides.
rigid::Vec3 vorticity(VelocitiesAround&, lbm::Int3 cell);

/// S of what arrives at a cell, xx yy zz xy xz yz: S = -3/(2 tau) [sum_i c_i c_i (g_i - g_i^eq) + (u F + F u)
/// / 2] (Chapman-Enskog with the force of Guo, Zheng, Shi 2002), in units of the finest lattice.
std::array<double, 6> strain_rate(const coupler::FluidFields&, const lbm::Moments&);
/// S : S.
double strain_rate_squared(const coupler::FluidFields&, const lbm::Moments&);

}  // namespace silt

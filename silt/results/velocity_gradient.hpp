#pragma once
// Derivatives of the velocity: vorticity, curl u, from differences of cell velocities on any rank, and the
// strain rate from the populations of a cell.
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

/// The velocities of fluid cells beyond the blocks of this rank.
class CellVelocities {
 public:
  /// The depth in cells beyond the face of a block.
  static constexpr int reach = 2;

  /// Exchanges velocities of cells within reach of faces of blocks cut by the box [lower, upper). Collective.
  CellVelocities(const coupler::FluidFields&, MPI_Comm, lbm::Int3 lower, lbm::Int3 upper);

  /// Returns the velocity of a cell beyond a block, up to `reach` cells along an axis from a cell of block
  /// and box; none if it is not fluid, or of another level.
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

/// The velocities of cells of a block and near it, computed plane by plane for callers that go along z; keeps
/// the planes within reach of one.
class VelocitiesAround {
 public:
  /// Takes cells [first, last) of a block along x and y, with those within CellVelocities::reach; `others`
  /// has the cells of other blocks. Refers to both.
  VelocitiesAround(const coupler::FluidFields&, const CellVelocities& others, int block, lbm::Int3 first,
                   lbm::Int3 last);

  /// Returns the velocity of one of these cells; none if it is not fluid.
  std::optional<rigid::Vec3> at(lbm::Int3 cell);

 private:
  using Plane = std::vector<std::optional<rigid::Vec3>>;
  static constexpr int kept = 2 * CellVelocities::reach + 1;
  void make(int z);

  const coupler::FluidFields& fields_;
  const CellVelocities& others_;
  int block_;
  lbm::Int3 low_, high_;  // computed cells [low, high)
  std::array<Plane, kept> plane_;
  std::array<int, kept> height_;  // of the planes; -1: none yet
};

/// Returns the vorticity of a fluid cell, in units of its level. Differences are central, or one-sided beside
/// cells that are not fluid or of another level: second order with two fluid cells, first with one, 0 with
/// none.
rigid::Vec3 vorticity(VelocitiesAround&, lbm::Int3 cell);

/// Returns S (xx yy zz xy xz yz) of the arriving populations: S = -3/(2 tau) [sum_i c_i c_i (g_i - g_i^eq) +
/// (u F + F u) / 2] (Chapman-Enskog with the force of Guo, Zheng, Shi 2002), in units of the finest lattice.
std::array<double, 6> strain_rate(const coupler::FluidFields&, const lbm::Moments&);
/// Returns S : S.
double strain_rate_squared(const coupler::FluidFields&, const lbm::Moments&);

}  // namespace silt

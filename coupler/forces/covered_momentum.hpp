#pragma once
// Momentum of cells that become covered or uncovered, in the form `exact` of the force (method.md, equation
// 38). Without the impulse debt it would act in jolts of a whole cell's momentum: noise of 58 % of the drag,
// for an array that moves at 0.05 with the fluid at 0.003 relative to it, instead of 0.68 %.
#include <array>
#include <span>
#include <unordered_map>
#include <vector>

#include "coupler/forces/row_sums.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"
#include "rigid/shapes/mass_properties.hpp"

namespace silt::coupler {

/// Returns the impulse that a body has yet to receive for covered cells; lattice units, world frame.
rigid::Vec3 impulse_debt(const rigid::BodySet&, std::size_t row);

/// Counts the cells of each body into its row's sums.
void add_cells(std::span<const BlockMap>, RowSums&);

/// Adds the decrease of the impulse debt to the sums of an owned row whose cells are complete.
void settle_debt(rigid::BodySet&, std::size_t row, RowSums&);

/// Sets the initial debt of an owned row from its cells, before the first step.
void begin_debt(rigid::BodySet&, std::size_t row, const RowSums&);

/// Momentum that bodies gain through covered and uncovered cells.
class CoveredMomentum {
 public:
  /// Adds momentum (lattice units, world frame) with an arm from the centre of mass; rounded once.
  void add(rigid::BodyId, const rigid::Vec3& momentum, const rigid::Vec3& arm);
  /// Adds all gains to the sums of the bodies' rows, and clears them.
  void add_to(RowSums&, const rigid::BodySet&);

 private:
  struct Gain {
    rigid::BodyId id;
    std::array<std::int64_t, 6> impulse;
  };
  std::vector<Gain> gains_;
};

/// Momentum of the cells of rotating walls (method-coupling.md, equation 38a). To avoid jolts, covered and
/// uncovered cells give only momentum relative to the wall's motion (take_cell in flow.cpp); this class gives
/// the mean of the rest.
class TurningWalls {
 public:
  /// An impulse on a wall, with the arm from the origin of its frame; lattice units, world frame.
  struct Impulse {
    rigid::BodyId wall;
    rigid::Vec3 momentum, arm;
  };
  /// Keeps a reference to the world.
  explicit TurningWalls(const rigid::World& world) : world_(world) {}
  /// Returns the momentum that the cells of mesh walls gain in a step by the walls' velocities.
  std::vector<Impulse> impulses(const rigid::BodySet&);

 private:
  const rigid::MassProperties& solid_of(std::int32_t shape);

  const rigid::World& world_;
  std::unordered_map<std::int32_t, rigid::MassProperties> solids_;  // by shape, for unit density
};

}  // namespace silt::coupler

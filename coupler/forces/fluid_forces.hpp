#pragma once
// Force evaluation (Algorithm 2): what surfaces return to the fluid and what the fluid does to the bodies, by
// momentum exchange over the cut links, summed in fixed point; and the coupling in time.
//
// `explicit` (the paper): the force of the links moves the body. `implicit`: the returned populations are
// linear in the wall velocity, so the owner solves (M + H) delta = F + F_ext for the change of velocity of
// this step, H = sum k J J^T, and the links return as if the surface had moved with v + delta already. Fixed
// and prescribed bodies: delta = 0. So have free ones that are heavy and large enough for the explicit step,
// body by body and step by step: it is as good there, and saves them the solve and the second pass. The force
// handed to the rigid step is F - H delta, what the links then give: with the external force it makes the
// kick delta. Contacts act after it. Where they held a body in the step before, F_ext includes what they will
// hold again, for the links only: else the surface of a body at rest would return as if it fell, step after
// step, and pump the fluid beneath it.
//
// Films in narrow gaps (lubrication) act after that, on the true mass. The external force of the implicit
// solve counts what they gave in the step before: else the links would return as if a body that a film holds
// were moving, by the velocity that the film is about to take away again, and the film would seem stiffer by
// the drag over the mass. A sudden blow is not counted.
//
// Form `exact`: besides what the links give, a body gains the momentum of the cells it covers and loses that
// of the cells it leaves (Aidun, Lu, Ding 1998). Handed over as it is, that comes in blows of a whole cell's
// momentum, as the body's cells are now more, now fewer than its volume: 58 % of the drag of an array that
// moves at 0.05 with the fluid at 0.003 relative to it. So a body is owed what its cells, moving with it,
// hold beyond its volume, momentum and angular momentum; this follows from where it is and how it moves, and
// what it is given is what it gains less the change of that. Noise 0.68 %, momentum of fluid, bodies and what
// they are owed conserved to rounding; a body that moves with the fluid feels nothing.
//
// History: none besides the state of bodies (their stored impulses and what they are owed with it) and
// populations.
#include <array>
#include <span>

#include "coupler/case/case.hpp"
#include "coupler/exchange/body_exchange.hpp"
#include "coupler/mapping/block_links.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "lbm/cut_links.hpp"
#include "lbm/fluid.hpp"

namespace silt::coupler {

/// Of a row: force (3) and torque (3) in quanta of lbm::link_quantum; with implicit coupling the stiffness
/// (21) in the quanta of lbm::StiffnessSums; with the form `exact` the body's cells (4, CellSums).
inline constexpr int force_width = 6, stiffness_width = 21, cells_width = 4;

/// Impulse that a body is still owed for cells that changed sides, lattice units, world frame.
rigid::Vec3 owed_impulse(const rigid::BodySet&, std::size_t row);

template <class T>
class FluidForces {
 public:
  /// substeps: of the bodies' step, for the impulses they remember.
  FluidForces(const CouplingSpec&, const BodyExchange&, int substeps);

  /// Collective, before the first step of all: bodies are owed what their cells hold at the start.
  void start(std::span<const BlockMap>, rigid::BodySet&);
  /// Momentum handed over by covered and uncovered cells (form `exact` only), from the next evaluation on:
  /// momentum gained by the body, lattice units, arm from its centre of mass. Rounded once to the quantum.
  void hand_over(rigid::BodyId, const rigid::Vec3& momentum, const rigid::Vec3& arm);
  // ---- a step ----
  /// Before the fluid's passes: the velocities with which surfaces return. The bodies stay where they are in
  /// memory until the step's last call.
  void begin(const lbm::Fluid<T>&, std::span<const BlockMap>, std::span<BlockLinks<T>>, rigid::BodySet&);
  /// The dense pass is done with a part of a block: what its links wait for is applied, and bodies all of
  /// whose links have been are solved for, while their populations are in cache.
  void after_part(lbm::Block<T>&, BlockLinks<T>&, int part, const rigid::Vec3& gravity);
  static bool waiting(const BlockLinks<T>& links, int part) {
    return std::size_t(part) + 1 < links.first_inner.size() &&
           links.first_inner[part] < links.first_inner[part + 1];
  }
  /// All other links and bodies, after the halo exchange.
  /// Collective. Returns the density that fluid cells of this rank gained through links, in mass quanta.
  std::int64_t operator()(lbm::Fluid<T>&, std::span<BlockLinks<T>>, rigid::BodySet&,
                          const rigid::Vec3& gravity);

  /// Force and torque of the last step on a wall (0: the first of the walls' rows), torque about its
  /// position, from this rank's blocks; in quanta of lbm::link_quantum.
  std::array<std::int64_t, 6> wall_load(std::size_t wall) const { return wall_loads_[wall]; }

 private:
  void apply(lbm::Block<T>&, const lbm::LinkSlots&, SurfaceLinks<T>&, const lbm::LinkGroup&,
             const lbm::NextGroup<T>&) const;
  std::int64_t apply_rims(lbm::Fluid<T>&, std::span<BlockLinks<T>>);
  void prefetch_row(const SurfaceLinks<T>&) const;
  void finish_body(lbm::Block<T>&, const lbm::LinkSlots&, SurfaceLinks<T>&, const rigid::Vec3& gravity);
  void gather(std::span<const BlockLinks<T>>, const rigid::BodySet&);
  void settle_owed(rigid::BodySet&, std::size_t row);
  void add_explicit(rigid::BodySet&);
  std::int64_t solve_implicit(lbm::Fluid<T>&, std::span<BlockLinks<T>>, rigid::BodySet&,
                              const rigid::Vec3& gravity);
  std::int64_t correct_open(lbm::Block<T>&, BlockLinks<T>&, const rigid::BodySet&,
                            std::span<const double> delta);

  CouplingSpec spec_;
  const BodyExchange& exchange_;
  rigid::BodySet* bodies_ = nullptr;  // of the step under way
  std::vector<std::int64_t> rows_;    // width a row
  int cells_begin_, width_;           // of a row
  int substeps_;                      // of the rigid step: stored impulses are those of one
  double heavy_ = 0;                  // largest eigenvalue of M^-1 H that the explicit step takes
  std::vector<std::array<std::int64_t, 6>> wall_loads_;
  struct HandedOver {
    rigid::BodyId id;
    std::int64_t impulse[6];
  };
  std::vector<HandedOver> handed_over_;
};

}  // namespace silt::coupler

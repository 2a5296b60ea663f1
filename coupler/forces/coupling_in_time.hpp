#pragma once
// Coupling in time: how the force that the links of a step have on a body becomes its change of velocity.
//
// `explicit` (the paper): the force of the links moves the body. `implicit`: the returned populations are
// linear in the wall velocity (README.md, equation 4), so the owner solves (M + H) delta = F + F_ext for the
// change of velocity of this step (6), and the links return as if the surface had moved with v + delta
// already: they are corrected, in a second pass. The force handed to the rigid step is F - H delta, what the
// links then give: with the external force it makes the kick delta. Contacts act after it. Fixed and
// prescribed bodies have delta = 0.
//
// A body whose links are soft beside its mass does without the second pass (7), body by body and step by
// step. Its links have returned as if it had moved with v + delta of the last step, what delta changes of
// that is made up for in the next step, and so is half of what moves it: the mean of two steps damps what
// changes sign in every one. A load that is balanced defers nothing.
//
// The external force (8) counts what lubrication films and contacts gave in the step before. Without the
// films, the links would return as if a body that a film holds were moving, by the velocity that the film is
// about to take away again, and the film would seem stiffer by the drag over the mass. Without the contacts,
// the surface of a body at rest would return as if it fell, step after step, and pump the fluid beneath it.
#include <Eigen/Core>

#include "coupler/case/coupling_spec.hpp"
#include "coupler/exchange/coupling_state.hpp"
#include "coupler/forces/row_sums.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"

namespace silt::coupler {

/// Adds force and torque of the links to the row's accumulators.
void add_link_force(rigid::BodySet&, std::size_t row, const RowSums&);

class ImplicitCoupling {
 public:
  /// `substeps` are those of the bodies' step, for the impulses they remember; `stiffness_quantum` is
  /// lbm::stiffness_quantum of the fluid's precision.
  ImplicitCoupling(const rigid::World&, const CouplingSpec&, int substeps, double relaxation_time,
                   double stiffness_quantum);

  /// Adds the force that the links give in the end to the row's accumulators, foresees the change of the next
  /// step, and returns the change of velocity and angular velocity with which the links are to be corrected:
  /// zero where one pass is enough. The row is owned and free, its sums complete.
  Vec6 take_velocity_change(rigid::BodySet&, std::size_t row, const RowSums&) const;

 private:
  Vec6 load_on(const rigid::BodySet&, std::size_t row, const Vec6& link_force) const;

  const rigid::World& world_;
  int substeps_;
  bool defers_;            // one pass is (7), else the explicit step
  double one_pass_limit_;  // largest eigenvalue of M^-1 H for one pass
  double stiffness_quantum_;
};

}  // namespace silt::coupler

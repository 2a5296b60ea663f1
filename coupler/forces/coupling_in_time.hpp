#pragma once
// Coupling in time: how the force that the links of a step have on a body becomes its change of velocity.
//
// `explicit` (the paper): the force of the links moves the body. `implicit`: the returned populations are
// linear in the wall velocity (README.md, equation 4), so the owner solves (M + H) delta = F + F_ext for the
// change of velocity of this step (6), and the links return as if the surface had moved with v + delta
// already. Fixed and prescribed bodies have delta = 0. So have free ones for which the explicit step is
// stable with room to spare (7), body by body and step by step: it is as good there, and saves them the
// solve and the second pass. The force handed to the rigid step is F - H delta, what the links then give:
// with the external force it makes the kick delta. Contacts act after it.
//
// The external force (8) counts what lubrication films and contacts gave in the step before. Without the
// films, the links would return as if a body that a film holds were moving, by the velocity that the film is
// about to take away again, and the film would seem stiffer by the drag over the mass. Without the contacts,
// the surface of a body at rest would return as if it fell, step after step, and pump the fluid beneath it.
#include <Eigen/Core>

#include "coupler/forces/row_sums.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"

namespace silt::coupler {

using Vec6 = Eigen::Matrix<double, 6, 1>;

/// Adds force and torque of the links to the row's accumulators.
void add_link_force(rigid::BodySet&, std::size_t row, const RowSums&);

class ImplicitCoupling {
 public:
  /// `substeps` are those of the bodies' step, for the impulses they remember; `stiffness_quantum` is
  /// lbm::stiffness_quantum of the fluid's precision.
  ImplicitCoupling(const rigid::World&, int substeps, double relaxation_time, double stiffness_quantum);

  /// Adds the force that the links give in the end to the row's accumulators, and returns delta: the change
  /// of velocity and angular velocity with which they are to be corrected. Zero where the explicit step is
  /// stable. The row is owned and free, its sums complete.
  Vec6 take_velocity_change(rigid::BodySet&, std::size_t row, const RowSums&) const;

 private:
  Vec6 load_on(const rigid::BodySet&, std::size_t row, const Vec6& link_force) const;

  const rigid::World& world_;
  int substeps_;
  double explicit_limit_;  // largest eigenvalue of M^-1 H that the explicit step takes
  double stiffness_quantum_;
};

}  // namespace silt::coupler

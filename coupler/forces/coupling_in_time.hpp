#pragma once
// Coupling in time: how the force that the links of a step have on a body becomes its change of velocity
// (method.md, equations 34 to 37). `explicit` (the paper): the force moves the body. `implicit`: the owner
// solves for the change of velocity of this step (35) and the links are corrected by it, in a second pass; a
// body whose links are soft beside its mass does without that (36). Contacts act after it. Fixed and
// prescribed bodies do not change.
#include <Eigen/Core>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/forces/row_sums.hpp"
#include "coupler/spec/coupling_spec.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"

namespace silt::coupler {

/// Adds force and torque of the links to the row's accumulators.
void add_link_force(rigid::BodySet&, std::size_t row, const RowSums&);

using Mat6 = Eigen::Matrix<double, 6, 6>;

/// Returns whether the largest eigenvalue of M^-1 H is at most `limit` for certain (method.md, equation 36):
/// M is the mass matrix of a body, H (symmetric, forces before torques, world frame, lattice units) the
/// resistance of its links. The eigenvalue is bounded from above, by the row sums of H scaled with the mass
/// and with the least that a principal moment can be. So a body near the limit may be refused, but none
/// beyond it is let through. `inertia_B` may be in any frame of the body.
bool largest_eigenvalue_is_within(double limit, const Mat6& resistance, double mass,
                                  const rigid::Mat3& inertia_B);

/// How the links of a body move it in a step: explicitly, implicitly with a second pass, or in one pass (36).
enum class TimeScheme { explicit_, implicit_, one_pass };

/// Each body in each step is coupled by one of two schemes, as its links are soft or stiff beside its mass.
class CouplingInTime {
 public:
  /// `substeps` are those of the bodies' step, for the impulses they remember; `resistance_quantum` is
  /// lbm::resistance_quantum of the fluid's precision.
  CouplingInTime(const rigid::World&, const CouplingSpec&, int substeps, double relaxation_time,
                 double resistance_quantum);

  const rigid::World& world() const { return world_; }
  /// Returns whether links may have to be corrected, for which their resistance is needed.
  bool is_implicit() const { return of_stiff_links_ == TimeScheme::implicit_; }
  /// Adds the force that the links give in the end to the row's accumulators, foresees the change of the next
  /// step, and returns the change of velocity and angular velocity with which the links are to be corrected:
  /// zero where one pass is enough. The row is owned and free, its sums complete.
  Vec6 take_velocity_change(rigid::BodySet&, std::size_t row, const RowSums&) const;

 private:
  struct Links {
    Vec6 force;
    Mat6 resistance;
  };
  Vec6 take_explicitly(rigid::BodySet&, std::size_t row, const Vec6& force) const;
  Vec6 take_implicitly(rigid::BodySet&, std::size_t row, const Links&) const;
  Vec6 take_in_one_pass(rigid::BodySet&, std::size_t row, const Links&) const;
  Vec6 load_on(const rigid::BodySet&, std::size_t row, const Vec6& link_force) const;
  Vec6 solve(rigid::BodySet&, std::size_t row, const Links&, const Vec6& load, const Vec6& left) const;

  const rigid::World& world_;
  int substeps_;
  TimeScheme of_stiff_links_, of_soft_links_;
  double soft_limit_;  // largest eigenvalue of M^-1 H of soft links
  double resistance_quantum_;
};

}  // namespace silt::coupler

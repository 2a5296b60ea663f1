#pragma once
// Coupling in time: from the links' force on a body to its change of velocity (method.md, equations 34 to
// 37). `explicit` (the paper): the force moves the body. `implicit`: the owner solves for the change of
// velocity in this step (35), and a second pass corrects the links; a body with soft links relative to its
// mass needs only one pass (36). Contacts act afterwards. Fixed and prescribed bodies do not change.
#include <Eigen/Core>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/forces/row_sums.hpp"
#include "coupler/spec/flow_spec.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"

namespace silt::coupler {

/// Adds force and torque of the links to the row's force and torque.
void add_link_force(rigid::BodySet&, std::size_t row, const RowSums&);

using Mat6 = Eigen::Matrix<double, 6, 6>;

/// Returns whether the largest eigenvalue of M^-1 H is certainly at most `limit` (method.md, equation 36),
/// with the mass matrix M and the resistance H of the links (symmetric, forces before torques, world frame,
/// lattice units). The upper bound uses row sums of H, scaled with the mass and a lower bound of the
/// principal moments, so it may return false for a body near the limit, but never true for one above.
/// `inertia_B` may be in any frame of the body.
bool largest_eigenvalue_is_within(double limit, const Mat6& resistance, double mass,
                                  const rigid::Mat3& inertia_B);

/// The coupling of a body in a step: explicit, implicit with a second pass, or in one pass (36).
enum class TimeScheme { explicit_, implicit_, one_pass };

/// Chooses one of two schemes for each body in each step, by whether its links are soft or stiff.
class CouplingInTime {
 public:
  /// substeps: of the bodies. resistance_quantum: lbm::resistance_quantum of the fluid's precision.
  CouplingInTime(const rigid::World&, const CouplingSpec&, int substeps, double relaxation_time,
                 double resistance_quantum);

  const rigid::World& world() const { return world_; }
  /// Returns whether links may need a correction, and thus their resistance.
  bool is_implicit() const { return of_stiff_links_ == TimeScheme::implicit_; }
  /// Adds the final force of the links to the row's force and torque, sets the foreseen change of the next
  /// step, and returns the change of velocity and angular velocity by which the links must be corrected, zero
  /// if one pass is enough. The row is owned and free, its sums complete.
  Vec6 apply_links(rigid::BodySet&, std::size_t row, const RowSums&) const;

 private:
  struct Links {
    Vec6 force;
    Mat6 resistance;
  };
  Vec6 apply_explicitly(rigid::BodySet&, std::size_t row, const Vec6& force) const;
  Vec6 apply_implicitly(rigid::BodySet&, std::size_t row, const Links&) const;
  Vec6 apply_in_one_pass(rigid::BodySet&, std::size_t row, const Links&) const;
  Vec6 load_on(const rigid::BodySet&, std::size_t row, const Vec6& link_force) const;
  Vec6 solve(rigid::BodySet&, std::size_t row, const Links&, const Vec6& load, const Vec6& left) const;

  const rigid::World& world_;
  int substeps_;
  TimeScheme of_stiff_links_, of_soft_links_;
  double soft_limit_;  // largest eigenvalue of M^-1 H for soft links
  double resistance_quantum_;
};

}  // namespace silt::coupler

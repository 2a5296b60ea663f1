#pragma once
// Whether the links of a body are soft beside its mass.
#include <Eigen/Core>

#include "rigid/math/types.hpp"

namespace silt::coupler {

/// Returns whether the largest eigenvalue of M^-1 H is at most `limit` for certain (README.md, equation 7): M
/// is the mass matrix of a body, H (symmetric, forces before torques, world frame, lattice units) the
/// stiffness of its links. The eigenvalue is bounded from above, by the row sums of H scaled with the mass
/// and with the least that a principal moment can be. So a body near the limit may be refused, but none
/// beyond it is let through. `inertia_B` may be in any frame of the body.
bool largest_eigenvalue_is_within(double limit, const Eigen::Matrix<double, 6, 6>& stiffness, double mass,
                                  const rigid::Mat3& inertia_B);

}  // namespace silt::coupler

#pragma once
// Which free bodies the explicit step may move, under implicit coupling.
#include <Eigen/Core>

#include "rigid/math/types.hpp"

namespace silt::coupler {

/// Whether the largest eigenvalue of M^-1 H is at most `limit` for certain: M mass and inertia of a body, H
/// (symmetric, forces before torques, world frame, lattice units) the stiffness of its links, sum k J J^T.
/// The eigenvalue is bounded from above, by the row sums of H scaled with the mass and with the least that a
/// principal moment can be; so a body near the limit may be taken for a light one, never the other way round.
/// `inertia_B` may be in any frame of the body.
bool is_heavy(const Eigen::Matrix<double, 6, 6>& stiffness, double mass, const rigid::Mat3& inertia_B,
              double limit);

}  // namespace silt::coupler

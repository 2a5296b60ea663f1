#include "coupler/forces/eigenvalue_bound.hpp"

#include <cmath>

namespace silt::coupler {

using rigid::Mat3;
using rigid::Vec3;

namespace {

/// Returns a lower bound of the principal moments (Gershgorin); where it says nothing, it is not above 0.
double least_moment(const Mat3& inertia) {
  const Mat3 sizes = inertia.cwiseAbs();
  return (2 * sizes.diagonal() - sizes.rowwise().sum()).minCoeff();
}

}  // namespace

bool largest_eigenvalue_is_within(double limit, const Eigen::Matrix<double, 6, 6>& stiffness, double mass,
                                  const Mat3& inertia_B) {
  if (stiffness(0, 0) > limit * mass) return false;  // light bodies
  const double moment = least_moment(inertia_B);
  if (!(moment > 0)) return false;
  Eigen::Matrix<double, 6, 1> scale;
  scale << Vec3::Constant(1 / std::sqrt(mass)), Vec3::Constant(1 / std::sqrt(moment));
  return scale.cwiseProduct(stiffness.cwiseAbs() * scale).maxCoeff() <= limit;
}

}  // namespace silt::coupler

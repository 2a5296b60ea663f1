#include "coupler/results/strain_rate.hpp"

#include "coupler/case/case.hpp"
#include "lbm/fluid.hpp"

namespace silt::coupler {

double strain_rate_squared(const Flow& flow, int b, lbm::Int3 cell, const lbm::Moments& m,
                           const FluidSpec& fluid) {
  constexpr int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  const rigid::Vec3& force = fluid.body_force;
  const auto u = flow.velocity(m);
  double flux[6] = {};  // of momentum, not in equilibrium: xx, yy, zz, xy, xz, yz
  for (int i = 1; i < lbm::directions; ++i) {
    const lbm::Int3 c = lbm::c[i];
    const double g = flow.arriving(b, cell, i);
    for (int k = 0; k < 6; ++k) flux[k] += g * c[pairs[k][0]] * c[pairs[k][1]];
  }
  double squares = 0;
  for (int k = 0; k < 6; ++k) {
    const auto [a, b] = pairs[k];
    flux[k] += 0.5 * (u[a] * force[b] + force[a] * u[b]) - u[a] * u[b];
    if (a == b) flux[k] -= m.density_deviation / 3;
    squares += (a == b ? 1 : 2) * flux[k] * flux[k];
  }
  return squares * 9 / (4 * fluid.relaxation_time * fluid.relaxation_time);
}

}  // namespace silt::coupler

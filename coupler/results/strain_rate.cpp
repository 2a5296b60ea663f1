#include "coupler/results/strain_rate.hpp"

#include "coupler/case/case.hpp"
#include "lbm/fluid.hpp"

namespace silt::coupler {

double strain_rate_squared(const FluidFields& fields, const lbm::Moments& m, const FluidSpec& fluid) {
  constexpr int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  const rigid::Vec3& force = fluid.body_force;
  const auto u = fields.velocity(m);
  double squares = 0;
  for (int k = 0; k < 6; ++k) {
    const auto [a, b] = pairs[k];
    double flux = m.flux[k];  // becomes that which is not in equilibrium
    flux += 0.5 * (u[a] * force[b] + force[a] * u[b]) - u[a] * u[b];
    if (a == b) flux -= m.density_deviation / 3;
    squares += (a == b ? 1 : 2) * flux * flux;
  }
  return squares * 9 / (4 * fluid.relaxation_time * fluid.relaxation_time);
}

}  // namespace silt::coupler

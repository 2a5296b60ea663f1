#include "coupler/forces/entrained_fluid.hpp"

#include <cmath>
#include <numbers>

#include "coupler/exchange/coupling_state.hpp"
#include "rigid/math/elementary.hpp"

namespace silt::coupler {

namespace {

constexpr double speed_of_sound = std::numbers::inv_sqrt3;
constexpr double negligible = 1e-9;  // change of velocity in cells a step; smaller rests are applied at once

double share_of_step(double displaced) {
  const double radius = rigid::elementary::cbrt(0.75 * displaced / std::numbers::pi);
  return 1 - rigid::elementary::exp(-speed_of_sound / radius);
}

}  // namespace

rigid::Vec3 EntrainedFluid::operator()(rigid::BodySet& bodies, const rigid::Impact& impact) const {
  const auto compliance = [&](std::size_t row) {  // including the entrained fluid
    return bodies.inverse_mass(row) / (1 + entrained_ * (1 - bodies.weight_in_fluid[row]));
  };
  const std::size_t a = impact.row_a, b = impact.row_b;
  const double reduced_mass = 1 / (bodies.inverse_mass(a) + bodies.inverse_mass(b));
  const double share = 1 / (reduced_mass * (compliance(a) + compliance(b))) - 1;
  const rigid::Vec3 impulse = share * impact.impulse * impact.normal;
  if (a < bodies.owned && bodies.is_dynamic(a)) coupling_of(bodies, a).pending_impact() -= impulse;
  if (b < bodies.owned && bodies.is_dynamic(b)) coupling_of(bodies, b).pending_impact() += impulse;
  return impulse;
}

void apply_pending_impacts(rigid::BodySet& bodies) {
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    Eigen::Map<rigid::Vec3> pending = coupling_of(bodies, row).pending_impact();
    if (pending == rigid::Vec3::Zero()) continue;
    const double mass = bodies.mass[row];
    const bool rest = pending.norm() < negligible * mass;
    const rigid::Vec3 due =
        rest ? rigid::Vec3(pending) : rigid::Vec3(share_of_step(bodies.displaced_mass(row)) * pending);
    bodies.add_force(row, due);
    pending -= due;
  }
}

}  // namespace silt::coupler

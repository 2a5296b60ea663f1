#include "coupler/forces/entrained_fluid.hpp"

#include <cmath>
#include <numbers>

namespace silt::coupler {

namespace {

constexpr double speed_of_sound = std::numbers::inv_sqrt3;
constexpr double negligible = 1e-9;  // change of velocity, cells a step: given at once

double share_of_step(double displaced) {
  const double radius = std::cbrt(0.75 * displaced / std::numbers::pi);
  return 1 - std::exp(-speed_of_sound / radius);
}

}  // namespace

void give_pending_blows(rigid::BodySet& bodies) {
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    rigid::Vec3& pending = bodies.pending_blow[row];
    if (pending == rigid::Vec3::Zero()) continue;
    const double mass = bodies.mass[row];
    const bool rest = pending.norm() < negligible * mass;
    const rigid::Vec3 due =
        rest ? pending : rigid::Vec3(share_of_step(mass * (1 - bodies.weight_factor[row])) * pending);
    bodies.add_force(row, due);
    pending -= due;
  }
}

}  // namespace silt::coupler

#include "coupler/noted_loads.hpp"

#include <algorithm>

#include "coupler/exchange/coupling_state.hpp"

namespace silt::coupler {

using rigid::Vec3;

namespace {

using Noted = double (CouplingState::*)[6];

std::vector<BodyLoad> of_owned(const rigid::BodySet& bodies, Noted noted) {
  std::vector<BodyLoad> loads;
  loads.reserve(bodies.owned);
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    const double* load = coupling_state(bodies, row).*noted;
    loads.push_back({Vec3(load[0], load[1], load[2]), Vec3(load[3], load[4], load[5])});
  }
  return loads;
}

}  // namespace

void note_loads(rigid::BodySet& bodies) {
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    const Vec3 force = bodies.force[row].value(), torque = bodies.torque[row].value();
    double* seen = coupling_state(bodies, row).seen_load;
    std::copy_n(force.data(), 3, seen);
    std::copy_n(torque.data(), 3, seen + 3);
  }
}

void note_contact_impulse(rigid::BodySet& bodies, std::size_t row, const Vec3& impulse,
                          const Vec3& angular_impulse) {
  double* load = coupling_state(bodies, row).contact_load;
  for (int d = 0; d < 3; ++d) load[d] += impulse[d], load[3 + d] += angular_impulse[d];
}

void forget_contact_loads(rigid::BodySet& bodies) {
  for (std::size_t row = 0; row < bodies.owned; ++row)
    std::fill_n(coupling_state(bodies, row).contact_load, 6, 0.);
}

std::vector<BodyLoad> noted_loads(const rigid::BodySet& bodies) {
  return of_owned(bodies, &CouplingState::seen_load);
}
std::vector<BodyLoad> noted_contact_loads(const rigid::BodySet& bodies) {
  return of_owned(bodies, &CouplingState::contact_load);
}

}  // namespace silt::coupler

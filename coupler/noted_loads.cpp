#include "coupler/noted_loads.hpp"

#include "coupler/exchange/coupling_state.hpp"

namespace silt::coupler {

using rigid::Vec3;

namespace {

std::vector<BodyLoad> of_owned(const rigid::BodySet& bodies, const rigid::HolderColumn& noted) {
  std::vector<BodyLoad> loads;
  loads.reserve(bodies.owned);
  for (std::size_t row = 0; row < bodies.owned; ++row)
    loads.push_back({vector_in<3>(bodies, row, noted), vector_in<3>(bodies, row, noted, 3)});
  return loads;
}

}  // namespace

void note_loads(rigid::BodySet& bodies) {
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    vector_in<3>(bodies, row, column::seen_load) = bodies.force[row].value();
    vector_in<3>(bodies, row, column::seen_load, 3) = bodies.torque[row].value();
  }
}

void note_contact_impulse(rigid::BodySet& bodies, std::size_t row, const Vec3& impulse,
                          const Vec3& angular_impulse) {
  vector_in<3>(bodies, row, column::contact_load) += impulse;
  vector_in<3>(bodies, row, column::contact_load, 3) += angular_impulse;
}

void forget_contact_loads(rigid::BodySet& bodies) {
  for (std::size_t row = 0; row < bodies.owned; ++row)
    vector_in<6>(bodies, row, column::contact_load).setZero();
}

std::vector<BodyLoad> noted_loads(const rigid::BodySet& bodies) {
  return of_owned(bodies, column::seen_load);
}
std::vector<BodyLoad> noted_contact_loads(const rigid::BodySet& bodies) {
  return of_owned(bodies, column::contact_load);
}

}  // namespace silt::coupler

#include "rigid/response/held_impulses.hpp"

#include <algorithm>

namespace silt::rigid {

void hold_or_release(BodySet& bodies, std::size_t row, std::span<const Contact> of_pair, bool hold) {
  if (row >= bodies.owned || !bodies.is_at_rest(row)) return;
  const bool is_a = bodies.id[row] == of_pair[0].a;
  const BodyId partner = is_a ? of_pair[0].b : of_pair[0].a;
  Rest& rest = bodies.rest[row];
  const double sign = (is_a ? -1 : 1) * (hold ? 1 : -1);
  for (StoredImpulse& s : bodies.stored_impulses[row]) {
    if (s.partner != partner || s.image != of_pair[0].image || s.held == hold) continue;
    const auto c = std::find_if(of_pair.begin(), of_pair.end(),
                                [&](const Contact& contact) { return contact.feature == s.feature; });
    if (hold && c == of_pair.end()) continue;
    s.held = hold;
    Eigen::Map<Vec3>{rest.impulse} += sign * s.impulse;
    if (c != of_pair.end())
      Eigen::Map<Vec3>{rest.angular_impulse} += sign * (is_a ? c->r_a : c->r_b).cross(s.impulse);
  }
}

void forget_last_impulses(BodySet& bodies, std::span<const std::size_t> in_contact) {
  for (std::size_t row = 0; row < bodies.owned; ++row)
    if (std::vector<StoredImpulse>& stored = bodies.stored_impulses[row];
        !stored.empty() && !bodies.keeps_impulses(row))
      stored.clear();
  for (const std::size_t row : in_contact)
    if (row < bodies.owned && bodies.keeps_impulses(row))
      std::erase_if(bodies.stored_impulses[row], [](const StoredImpulse& s) { return !s.held; });
}

void add_load(const BodySet& bodies, std::size_t row_a, std::size_t row_b, std::span<const Contact> contacts,
              std::span<const ContactImpulse> impulses, StepVelocities& velocities) {
  const auto add = [&](std::size_t row, const Vec3& r, const Vec3& impulse) {
    if (!bodies.is_at_rest(row)) return;
    velocities.load[row] += impulse;
    velocities.angular_load[row] += r.cross(impulse);
  };
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const Vec3 impulse = impulses[k].along(contacts[k].normal);
    add(row_a, contacts[k].r_a, -impulse);
    add(row_b, contacts[k].r_b, impulse);
  }
}

}  // namespace silt::rigid

#include "coupler/forces/contact_torque.hpp"

#include <algorithm>

namespace silt::coupler {

using rigid::Contact;
using rigid::StoredImpulse;
using rigid::Vec3;

std::vector<ContactTorque> contact_torques(const rigid::BodySet& bodies, std::span<const Contact> contacts,
                                           const rigid::Extent& extent) {
  std::vector<ContactTorque> found;
  for (const Contact& c : contacts) {
    if (c.b < rigid::first_tube_id) continue;
    const std::size_t row = bodies.row_of(c.a);
    if (row >= bodies.owned) continue;
    const std::vector<StoredImpulse>& stored = bodies.stored_impulses[row];
    const auto pressed = std::find_if(stored.begin(), stored.end(), [&](const StoredImpulse& s) {
      return s.partner == c.b && s.image == c.image && s.feature == c.feature;
    });
    if (pressed == stored.end()) continue;
    const Vec3 point = bodies.position[bodies.row_of(c.b)] + extent.shift(c.image);
    found.push_back({static_cast<int>(c.b - rigid::first_tube_id),
                     (bodies.position[row] + c.r_a - point).cross(pressed->impulse)});
  }
  return found;
}

}  // namespace silt::coupler

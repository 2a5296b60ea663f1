#include "coupler/forces/contact_torque.hpp"

#include <algorithm>

namespace silt::coupler {

using rigid::Contact;
using rigid::StoredImpulse;
using rigid::Vec3;

namespace {
Vec3 point_of(const rigid::BodySet& bodies, rigid::BodyId wall, rigid::Image image,
              const rigid::Extent& extent) {
  return bodies.position[bodies.row_of(wall)] + extent.shift(image);
}
}  // namespace

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
    const Vec3 arm = bodies.position[row] + c.r_a - point_of(bodies, c.b, c.image, extent);
    found.push_back({static_cast<int>(c.b - rigid::first_tube_id), arm.cross(pressed->impulse)});
  }
  return found;
}

void add_wall_impulses(const rigid::BodySet& bodies, std::span<const rigid::OtherWallImpulse> others,
                       const rigid::Extent& extent, std::vector<WallImpulse>& found) {
  for (const rigid::OtherWallImpulse& other : others) {
    const Vec3 arm = bodies.position[other.row] - point_of(bodies, other.wall, other.image, extent);
    found.push_back({other.wall, other.impulse, arm.cross(other.impulse) + other.moment});
  }
}

}  // namespace silt::coupler

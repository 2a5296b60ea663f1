#include "coupler/forces/contact_torque.hpp"

#include <algorithm>

namespace silt::coupler {

using rigid::Contact;
using rigid::StoredImpulse;
using rigid::Vec3;

std::vector<ContactTorque> contact_torques(const rigid::BodySet& bodies, std::span<const Contact> contacts,
                                           std::span<const rigid::FilmOnWall> films,
                                           const rigid::Extent& extent) {
  std::vector<ContactTorque> found;
  const auto point_of = [&](rigid::BodyId wall, rigid::Image image) -> Vec3 {
    return bodies.position[bodies.row_of(wall)] + extent.shift(image);
  };
  for (const Contact& c : contacts) {
    if (c.b < rigid::first_tube_id) continue;
    const std::size_t row = bodies.row_of(c.a);
    if (row >= bodies.owned) continue;
    const std::vector<StoredImpulse>& stored = bodies.stored_impulses[row];
    const auto pressed = std::find_if(stored.begin(), stored.end(), [&](const StoredImpulse& s) {
      return s.partner == c.b && s.image == c.image && s.feature == c.feature;
    });
    if (pressed == stored.end()) continue;
    const Vec3 arm = bodies.position[row] + c.r_a - point_of(c.b, c.image);
    found.push_back({static_cast<int>(c.b - rigid::first_tube_id), arm.cross(pressed->impulse)});
  }
  for (const rigid::FilmOnWall& film : films) {
    if (film.wall < rigid::first_tube_id) continue;
    const Vec3 arm = bodies.position[film.row] - point_of(film.wall, film.image);
    found.push_back(
        {static_cast<int>(film.wall - rigid::first_tube_id), arm.cross(film.impulse) + film.moment});
  }
  return found;
}

}  // namespace silt::coupler

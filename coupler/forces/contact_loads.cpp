#include "coupler/forces/contact_loads.hpp"

#include <algorithm>
#include <tuple>

namespace silt::coupler {

using rigid::Contact;
using rigid::StoredImpulse;
using rigid::Vec3;

namespace {

Vec3 point_of(const rigid::BodySet& bodies, rigid::BodyId wall, rigid::Image image,
              const rigid::Extent& extent) {
  return bodies.position[bodies.row_of(wall)] + extent.shift(image);
}

/// The contact that an impulse is of; none if nobody looked at it.
const Contact* find(std::span<const Contact> contacts, rigid::BodyId a, rigid::BodyId b,
                    const StoredImpulse& s) {
  const auto key = std::tuple(a, b, s.image, s.feature);
  const auto at = std::lower_bound(contacts.begin(), contacts.end(), key,
                                   [](const Contact& c, const auto& k) { return c.key() < k; });
  return at != contacts.end() && at->key() == key ? &*at : nullptr;
}

}  // namespace

std::vector<ContactLoad> contact_loads(const rigid::BodySet& bodies, std::span<const Contact> contacts,
                                       const rigid::Extent& extent) {
  std::vector<ContactLoad> found;
  for (std::size_t row = 0; row < bodies.owned; ++row)
    for (const StoredImpulse& s : bodies.stored_impulses[row]) {
      const std::size_t on = bodies.row_of(s.partner);
      const bool is_side = s.partner >= rigid::first_wall_id && s.partner < rigid::first_tube_id;
      if (is_side || on >= bodies.size() || bodies.is_dynamic(on)) continue;
      const bool is_second = s.partner > bodies.id[row];  // the impulse is that on the second
      const Contact* const c = is_second ? find(contacts, bodies.id[row], s.partner, s)
                                         : find(contacts, s.partner, bodies.id[row], s);
      Vec3 arm = Vec3::Zero();
      if (c && is_second)
        arm = bodies.position[row] + c->r_a - point_of(bodies, s.partner, s.image, extent);
      else if (c)
        arm = c->r_a;
      const Vec3 impulse = is_second ? s.impulse : Vec3(-s.impulse);
      found.push_back({s.partner, bodies.kind[on], impulse, arm.cross(impulse)});
    }
  return found;
}

std::vector<ContactMoment> contact_moments(const rigid::BodySet& bodies, std::span<const Contact> contacts) {
  std::vector<ContactMoment> found;
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    if (bodies.stored_impulses[row].empty()) continue;
    ContactMoment& of = found.emplace_back(ContactMoment{bodies.kind[row], bodies.position[row], {}});
    for (const StoredImpulse& s : bodies.stored_impulses[row]) {
      const bool is_first = s.partner > bodies.id[row];
      const Contact* const c = is_first ? find(contacts, bodies.id[row], s.partner, s)
                                        : find(contacts, s.partner, bodies.id[row], s);
      if (!c) continue;
      const auto product =
          is_first ? symmetric_product(c->r_a, -s.impulse) : symmetric_product(c->r_b, s.impulse);
      for (int k = 0; k < 6; ++k) of.moment[k] += product[k];
    }
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

#include "rigid/response/warm_start.hpp"

namespace silt::rigid {
namespace {

const StoredImpulse* find(std::span<const StoredImpulse> of_partner, const Contact& c) {
  const StoredImpulse* other_image = nullptr;
  for (const StoredImpulse& s : of_partner) {
    if (s.feature != c.feature) continue;
    if (s.image == c.image) return &s;
    if (!other_image) other_image = &s;
  }
  return other_image;
}

/// Returns the index in `stored` where the partner's impulses begin.
std::size_t read_stored(std::span<const StoredImpulse> stored, BodyId partner,
                        std::span<const Contact> contacts, std::span<ContactImpulse> impulses) {
  auto first = stored.begin();  // a linear search: a body has few partners
  while (first != stored.end() && first->partner < partner) ++first;
  auto last = first;
  while (last != stored.end() && last->partner == partner) ++last;
  bool known = first == last;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const Contact& c = contacts[k];
    const StoredImpulse* s = find({first, last}, c);
    known |= s != nullptr;
    ContactImpulse& p = impulses[k];
    Vec3 impulse = s ? s->impulse : Vec3(Vec3::Zero());
    if (s && !p.last_normal.isZero(0)) impulse = rotation_between(p.last_normal, c.normal) * impulse;
    const double along = c.normal.dot(impulse), normal = along + p.pull;
    if (!s || (normal <= 0 && !c.lubrication)) continue;
    p.normal = normal;
    p.pressed = normal > 0;
    p.tangential = impulse - along * c.normal;
    if (c.lubrication) continue;  // a film may pull, and resists sliding without pressing
    const double size = p.tangential.norm(), limit = c.friction * normal;
    if (size > limit) p.tangential *= limit / size;
  }
  if (!known)
    for (ContactImpulse& p : impulses) p.pressed = true;
  return static_cast<std::size_t>(first - stored.begin());
}

}  // namespace

void WarmStart::from_lower(std::size_t row_a, std::span<const Contact> contacts,
                           std::span<ContactImpulse> impulses) {
  if (row_a != row_) {
    row_ = row_a;
    behind_ = 0;
  }
  behind_ += read_stored(std::span(bodies_.stored_impulses[row_a]).subspan(behind_), contacts[0].b, contacts,
                         impulses);
}

void WarmStart::from_higher(std::size_t row_b, std::span<const Contact> contacts,
                            std::span<ContactImpulse> impulses) const {
  read_stored(bodies_.stored_impulses[row_b], contacts[0].a, contacts, impulses);
}

void forget_impulses(BodySet& bodies, BodyId id) {
  for (std::size_t row = 0; row < bodies.size(); ++row) {
    const auto given = [&](const StoredImpulse& s) { return s.partner == id || bodies.id[row] == id; };
    std::erase_if(bodies.stored_impulses[row], given);
  }
}

/// Zeros are stored without a sign, which may depend on the other pairs in a group.
void remember_impulses(std::span<const Contact> contacts, std::span<const ContactImpulse> impulses,
                       BodyId partner, std::vector<StoredImpulse>& stored) {
  for (std::size_t k = 0; k < contacts.size(); ++k)
    if (impulses[k].normal > 0 || contacts[k].lubrication)
      stored.push_back({partner, contacts[k].image, contacts[k].feature,
                        impulses[k].along(contacts[k].normal) + Vec3::Zero()});
}

}  // namespace silt::rigid

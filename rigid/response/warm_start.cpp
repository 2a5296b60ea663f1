#include "rigid/response/warm_start.hpp"

#include <algorithm>
#include <tuple>

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

/// Returns where the partner's begin in `stored`.
std::size_t recall(std::span<const StoredImpulse> stored, BodyId partner, std::span<const Contact> contacts,
                   std::span<ContactImpulse> impulses) {
  auto first = stored.begin();  // a body has few partners
  while (first != stored.end() && first->partner < partner) ++first;
  auto last = first;
  while (last != stored.end() && last->partner == partner) ++last;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const Contact& c = contacts[k];
    const StoredImpulse* s = find({first, last}, c);
    ContactImpulse& p = impulses[k];
    const double along = s ? c.normal.dot(s->impulse) : 0, normal = along + p.pull;
    if (!s || (normal <= 0 && !c.lubrication)) continue;
    p.normal = normal;
    p.tangential = s->impulse - along * c.normal;
    if (c.lubrication) continue;  // pulls as well, and drags without pressing
    const double size = p.tangential.norm(), limit = c.friction * normal;
    if (size > limit) p.tangential *= limit / size;
  }
  return static_cast<std::size_t>(first - stored.begin());
}

}  // namespace

void Recall::of_lower(std::size_t row_a, std::span<const Contact> contacts,
                      std::span<ContactImpulse> impulses) {
  if (row_a != row_) {
    row_ = row_a;
    behind_ = 0;
  }
  behind_ +=
      recall(std::span(bodies_.stored_impulses[row_a]).subspan(behind_), contacts[0].b, contacts, impulses);
}

void Recall::of_higher(std::size_t row_b, std::span<const Contact> contacts,
                       std::span<ContactImpulse> impulses) const {
  recall(bodies_.stored_impulses[row_b], contacts[0].a, contacts, impulses);
}

void hold_or_release(BodySet& bodies, std::size_t row, std::span<const Contact> of_pair, bool hold) {
  if (row >= bodies.owned || !bodies.is_at_rest(row)) return;
  const bool is_a = bodies.id[row] == of_pair[0].a;
  const BodyId partner = is_a ? of_pair[0].b : of_pair[0].a;
  Rest& rest = bodies.rest[row];
  const double sign = (is_a ? -1 : 1) * (hold ? 1 : -1);
  for (StoredImpulse& s : bodies.stored_impulses[row]) {
    if (s.partner != partner || s.image != of_pair[0].image || s.held == hold) continue;
    const auto c =
        std::ranges::find_if(of_pair, [&](const Contact& contact) { return contact.feature == s.feature; });
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

void sort_by_partner(std::vector<StoredImpulse>& stored) {
  std::sort(stored.begin(), stored.end(), [](const StoredImpulse& a, const StoredImpulse& b) {
    return std::tie(a.partner, a.image, a.feature) < std::tie(b.partner, b.image, b.feature);
  });
}

void forget_impulses(BodySet& bodies, BodyId id) {
  for (std::size_t row = 0; row < bodies.size(); ++row) {
    const auto given = [&](const StoredImpulse& s) { return s.partner == id || bodies.id[row] == id; };
    if (std::erase_if(bodies.stored_impulses[row], given) > 0) bodies.wake(row);
  }
}

/// Zeros without a sign: which one a lane's zero has may depend on the pairs beside it.
void remember_impulses(std::span<const Contact> contacts, std::span<const ContactImpulse> impulses,
                       BodyId partner, std::vector<StoredImpulse>& stored) {
  for (std::size_t k = 0; k < contacts.size(); ++k)
    if (impulses[k].normal > 0 || contacts[k].lubrication)
      stored.push_back({partner, contacts[k].image, contacts[k].feature,
                        impulses[k].along(contacts[k].normal) + Vec3::Zero()});
}

}  // namespace silt::rigid

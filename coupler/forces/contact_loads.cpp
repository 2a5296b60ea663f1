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

/// Appends the load that a contact with an owned free body puts on the other one, if that does not move by
/// it.
class LoadList {
 public:
  LoadList(const rigid::BodySet& bodies, const rigid::Extent& extent, std::vector<ContactLoad>& found)
      : bodies_(bodies), extent_(extent), found_(found) {}

  /// `c`: null if nobody looked at it; `impulse` and `moment`: on the second body.
  void add(rigid::BodyId on, bool is_second, rigid::Image image, const Contact* c, const Vec3& impulse,
           const Vec3& moment) {
    const std::size_t row = bodies_.row_of(on);
    if (row >= bodies_.size() || bodies_.is_dynamic(row)) return;
    Vec3 arm = Vec3::Zero();
    if (c && is_second)
      arm = bodies_.position[bodies_.row_of(c->a)] + c->r_a - point_of(bodies_, on, image, extent_);
    else if (c)
      arm = c->r_a;
    const double sign = is_second ? 1 : -1;
    found_.push_back({on, bodies_.kind[row], sign * impulse, sign * (arm.cross(impulse) + moment)});
  }

 private:
  const rigid::BodySet& bodies_;
  const rigid::Extent& extent_;
  std::vector<ContactLoad>& found_;
};

}  // namespace

void add_contact_loads(const ContactsInStep& step, const rigid::Extent& extent,
                       std::vector<ContactLoad>& found) {
  const rigid::BodySet& bodies = step.bodies;
  LoadList loads(bodies, extent, found);
  for (std::size_t row = 0; row < bodies.owned; ++row)
    for (const StoredImpulse& s : bodies.stored_impulses[row]) {
      const bool is_second = s.partner > bodies.id[row];  // the impulse is that on the second
      const Contact* const c = is_second ? find(step.contacts, bodies.id[row], s.partner, s)
                                         : find(step.contacts, s.partner, bodies.id[row], s);
      loads.add(s.partner, is_second, s.image, c, s.impulse, Vec3::Zero());
    }
  for (const rigid::OtherImpulse& other : step.other) {
    const Contact& c = step.contacts[other.contact];
    if (bodies.row_of(c.a) < bodies.owned) loads.add(c.b, true, c.image, &c, other.impulse, other.moment);
    if (bodies.row_of(c.b) < bodies.owned) loads.add(c.a, false, c.image, &c, other.impulse, other.moment);
  }
}

void add_contact_moments(const ContactsInStep& step, std::vector<ContactMoment>& found) {
  const rigid::BodySet& bodies = step.bodies;
  const auto add = [&](std::size_t row, bool is_first, const Contact& c, const Vec3& impulse) {
    found.push_back({bodies.kind[row], bodies.position[row],
                     is_first ? symmetric_product(c.r_a, -impulse) : symmetric_product(c.r_b, impulse)});
  };
  for (std::size_t row = 0; row < bodies.owned; ++row)
    for (const StoredImpulse& s : bodies.stored_impulses[row]) {
      const bool is_first = s.partner > bodies.id[row];
      const Contact* const c = is_first ? find(step.contacts, bodies.id[row], s.partner, s)
                                        : find(step.contacts, s.partner, bodies.id[row], s);
      if (c) add(row, is_first, *c, s.impulse);
    }
  for (const rigid::OtherImpulse& other : step.other) {
    const Contact& c = step.contacts[other.contact];
    for (const bool is_first : {true, false})
      if (const std::size_t row = bodies.row_of(is_first ? c.a : c.b);
          row < bodies.owned && bodies.is_dynamic(row))
        add(row, is_first, c, other.impulse);
  }
}

}  // namespace silt::coupler

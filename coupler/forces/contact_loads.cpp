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

/// Calls visit(row, is_first, contact, impulse) for each contact and each of its owned bodies that stores its
/// impulse, the one on the second body.
template <class Visit>
void for_remembered(const ContactsInStep& step, Visit&& visit) {
  const rigid::BodySet& bodies = step.bodies;
  for (std::size_t row = 0; row < bodies.owned; ++row)
    for (const StoredImpulse& s : bodies.stored_impulses[row]) {
      const auto [a, b] = std::minmax({bodies.id[row], s.partner});
      const auto key = std::tuple(a, b, s.image, s.feature & ~rigid::lubrication_feature);
      const auto c = std::ranges::lower_bound(step.contacts, key, {}, &Contact::key);
      if (c != step.contacts.end() && c->key() == key) visit(row, a == bodies.id[row], *c, s.impulse);
    }
}

/// Appends the loads of owned free bodies' contacts on walls and on bodies of infinite mass.
class LoadList {
 public:
  LoadList(const rigid::BodySet& bodies, const rigid::Extent& extent, std::vector<ContactLoad>& found)
      : bodies_(bodies), extent_(extent), found_(found) {}

  /// `impulse` and `moment` are those on the second body.
  void add(bool on_second, const Contact& c, const Vec3& impulse, const Vec3& moment) {
    const rigid::BodyId on = on_second ? c.b : c.a;
    const std::size_t row = bodies_.row_of(on);
    if (row >= bodies_.size() || bodies_.is_dynamic(row)) return;
    Vec3 arm = c.r_a;
    if (on_second)
      arm = bodies_.position[bodies_.row_of(c.a)] + c.r_a - point_of(bodies_, on, c.image, extent_);
    const double sign = on_second ? 1 : -1;
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
  for_remembered(step, [&](std::size_t, bool is_first, const Contact& c, const Vec3& impulse) {
    loads.add(is_first, c, impulse, Vec3::Zero());
  });
  for (const rigid::OtherImpulse& other : step.other) {
    const Contact& c = step.contacts[other.contact];
    if (bodies.row_of(c.a) < bodies.owned) loads.add(true, c, other.impulse, other.moment);
    if (bodies.row_of(c.b) < bodies.owned) loads.add(false, c, other.impulse, other.moment);
  }
}

void add_contact_moments(const ContactsInStep& step, const rigid::Extent& extent,
                         std::vector<ContactMoment>& found) {
  const rigid::BodySet& bodies = step.bodies;
  const auto add = [&](std::size_t row, bool is_first, const Contact& c, const Vec3& impulse) {
    Vec3 position = bodies.position[row];
    std::array<std::int32_t, 3> image{};
    extent.wrap(position, image);
    found.push_back({bodies.kind[row], position,
                     is_first ? symmetric_product(c.r_a, -impulse) : symmetric_product(c.r_b, impulse)});
  };
  for_remembered(step, add);
  for (const rigid::OtherImpulse& other : step.other) {
    const Contact& c = step.contacts[other.contact];
    for (const bool is_first : {true, false})
      if (const std::size_t row = bodies.row_of(is_first ? c.a : c.b);
          row < bodies.owned && bodies.is_dynamic(row))
        add(row, is_first, c, other.impulse);
  }
}

}  // namespace silt::coupler

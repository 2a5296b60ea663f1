#pragma once
// What a step remembers of its contact impulses for the next one. Both bodies of a pair keep the same values,
// so that the owner of either can start from them.
#include <span>

#include "rigid/body_set.hpp"

namespace silt::rigid {

/// The impulse of one contact, on b.
struct ContactImpulse {
  double normal = 0;
  Vec3 tangential = Vec3::Zero();  // W

  Vec3 along(const Vec3& n) const { return normal * n + tangential; }
};

/// Sets the impulses of a pair's contacts (in the order of the contacts, sorted by key) to those that
/// `stored` holds, laid on the new normal and inside the cone. `partner`: the other body. A contact not found
/// starts at zero. Where the pair's image changed (a body crossed a periodic side) the same feature of
/// another image will do. Returns where the partner's begin in `stored`: a higher partner can be looked for
/// from there.
std::size_t recall_impulses(std::span<const StoredImpulse> stored, BodyId partner, std::span<const Contact>,
                            std::span<ContactImpulse>);

/// Appends the pair's impulses to what one of its bodies remembers.
void remember_impulses(std::span<const Contact>, std::span<const ContactImpulse>, BodyId partner,
                       std::vector<StoredImpulse>& stored);

}  // namespace silt::rigid

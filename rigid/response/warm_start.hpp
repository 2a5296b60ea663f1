#pragma once
// The warm start: contact impulses of the last step as initial values. Both bodies of a pair store the same
// values, so that the owner of either can start from them.
#include <span>

#include "rigid/response/contact_resolver.hpp"

namespace silt::rigid {

/// The impulse of a contact on b.
struct ContactImpulse {
  double normal = 0;
  Vec3 tangential = Vec3::Zero();   // W
  double pull = 0;                  // by cohesion; included in the normal impulse
                                    // (rigid/response/contact_targets.hpp)
  bool pressed = false;             // in the last step, at this or another contact of the pair
  double kept_gap = 0;              // for a pull: the gap that must not grow
  Vec3 last_normal = Vec3::Zero();  // for a pull: the normal of the last step; zero: the current one

  Vec3 along(const Vec3& n) const { return (normal - pull) * n + tangential; }
};

/// Sets the impulses of pairs (contacts sorted by key) from those stored with one of their bodies, rotated to
/// the new normal and, without a lubrication film, projected onto the friction cone. A contact not found
/// keeps its impulse. If a body has crossed a periodic side, the same feature of another image is used.
class WarmStart {
 public:
  explicit WarmStart(const BodySet& bodies) : bodies_(bodies), row_(bodies.size()) {}
  /// Uses the list of the pair's body of lower id. Call in the order of the keys.
  void from_lower(std::size_t row_a, std::span<const Contact>, std::span<ContactImpulse>);
  void from_higher(std::size_t row_b, std::span<const Contact>, std::span<ContactImpulse>) const;

 private:
  const BodySet& bodies_;
  std::size_t row_, behind_ = 0;  // entries of row_'s list that belong to earlier partners
};

/// Appends the pair's impulses to the list of one of its bodies.
void remember_impulses(std::span<const Contact>, std::span<const ContactImpulse>, BodyId partner,
                       std::vector<StoredImpulse>& stored);

/// Deletes the impulses between a body and its partners, for a body moved away from them.
void forget_impulses(BodySet&, BodyId);

}  // namespace silt::rigid

#pragma once
// A step remembers its contact impulses for the next one. Both bodies of a pair keep the same values, so that
// the owner of either can start from them.
#include <span>

#include "rigid/response/contact_resolver.hpp"

namespace silt::rigid {

/// The impulse of one contact, on b.
struct ContactImpulse {
  double normal = 0;
  Vec3 tangential = Vec3::Zero();   // W
  double pull = 0;                  // by cohesion, against which the normal impulse presses besides
                                    // (rigid/response/contact_targets.hpp)
  bool pressed = false;             // in the step before; also where the bodies then met at other points only
  double kept_gap = 0;              // where there is a pull, the gap that is not to grow
  Vec3 last_normal = Vec3::Zero();  // of the pull in the step before; zero: as it is now

  Vec3 along(const Vec3& n) const { return (normal - pull) * n + tangential; }
};

/// Starts the impulses of pairs (contacts sorted by key) from what one of their bodies remembers, laid on the
/// new normal and (without a lubrication film) inside the cone. A contact not found keeps its impulse. Where
/// the pair's image changed (a body crossed a periodic side) the same feature of another image will do.
class Recall {
 public:
  explicit Recall(const BodySet& bodies) : bodies_(bodies), row_(bodies.size()) {}
  /// Starts from what the pair's lower body remembers. Call in the order of the keys.
  void of_lower(std::size_t row_a, std::span<const Contact>, std::span<ContactImpulse>);
  void of_higher(std::size_t row_b, std::span<const Contact>, std::span<ContactImpulse>) const;

 private:
  const BodySet& bodies_;
  std::size_t row_, behind_ = 0;  // what row_ remembers of partners that have been
};

/// Appends the pair's impulses to what one of its bodies remembers.
void remember_impulses(std::span<const Contact>, std::span<const ContactImpulse>, BodyId partner,
                       std::vector<StoredImpulse>& stored);

/// Forgets the impulses that a body and others gave each other: it is put where it no longer meets them.
void forget_impulses(BodySet&, BodyId);

}  // namespace silt::rigid

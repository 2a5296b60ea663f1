#include "rigid/warm_start.hpp"

#include <algorithm>

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

}  // namespace

void recall_impulses(std::span<const StoredImpulse> stored, BodyId partner, std::span<const Contact> contacts,
                     std::span<ContactRow> rows) {
  const auto first =
      std::partition_point(stored.begin(), stored.end(), [&](auto& s) { return s.partner < partner; });
  const auto last = std::partition_point(first, stored.end(), [&](auto& s) { return s.partner == partner; });
  const std::span<const StoredImpulse> of_partner(first, last);
  if (of_partner.empty()) return;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const StoredImpulse* s = find(of_partner, contacts[k]);
    if (!s) continue;
    ContactRow& row = rows[k];
    const double normal = row.normal().dot(s->impulse);
    if (normal <= 0) continue;
    row.impulse = {normal, row.direction[1].dot(s->impulse), row.direction[2].dot(s->impulse)};
    const double size = row.tangential_impulse(), limit = row.friction * normal;
    if (size > limit) row.impulse[1] *= limit / size, row.impulse[2] *= limit / size;
  }
}

void remember_impulses(std::span<const Contact> contacts, std::span<const ContactRow> rows, BodyId partner,
                       std::vector<StoredImpulse>& stored) {
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (rows[k].impulse[0] > 0)
      stored.push_back({partner, contacts[k].image, contacts[k].feature, rows[k].impulse_W()});
}

}  // namespace silt::rigid

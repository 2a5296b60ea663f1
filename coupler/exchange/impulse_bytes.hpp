#pragma once
// Stored impulses of a body as bytes of a message.
#include <vector>

#include "parallel/messages.hpp"
#include "rigid/bodies/body_set.hpp"

namespace silt::coupler {

struct PackedImpulse {
  rigid::BodyId partner;
  std::uint64_t feature;
  double impulse[3];
  std::int8_t image[4], held;
  std::int8_t unused[3];
};

inline void put_impulses(parallel::Bytes& to, const std::vector<rigid::StoredImpulse>& impulses) {
  parallel::put(to, static_cast<std::uint64_t>(impulses.size()));
  for (const rigid::StoredImpulse& s : impulses)
    parallel::put(to, PackedImpulse{s.partner,
                                    s.feature,
                                    {s.impulse[0], s.impulse[1], s.impulse[2]},
                                    {s.image.x, s.image.y, s.image.z},
                                    s.held,
                                    {}});
}

inline std::vector<rigid::StoredImpulse> take_impulses(parallel::ByteReader& from) {
  std::vector<rigid::StoredImpulse> impulses(from.take<std::uint64_t>());
  for (rigid::StoredImpulse& s : impulses) {
    const auto p = from.take<PackedImpulse>();
    s = {p.partner,
         {p.image[0], p.image[1], p.image[2]},
         p.feature,
         {p.impulse[0], p.impulse[1], p.impulse[2]},
         p.held != 0};
  }
  return impulses;
}

}  // namespace silt::coupler

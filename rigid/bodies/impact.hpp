#pragma once
// Impacts, as a resolver reports them: contacts that change the velocities of two bodies at once.
#include <cstddef>

#include "rigid/bodies/body_set.hpp"

namespace silt::rigid {

struct Impact {
  std::size_t row_a, row_b;  // of the BodySet
  Vec3 normal;               // unit, from a to b, W
  double impulse;            // on b along the normal, mass times velocity in lattice units
};

/// Whoever has to do something about impacts. It is told of each once its impulse is final, on every rank
/// that solved the pair (that owns one of its free bodies), in the order of the contacts, the same to the bit
/// on each.
class ImpactSink {
 public:
  virtual ~ImpactSink() = default;
  /// Returns what b gets besides the impulse reported, and a the reverse of, in time; W.
  virtual Vec3 operator()(BodySet&, const Impact&) const = 0;
};

}  // namespace silt::rigid

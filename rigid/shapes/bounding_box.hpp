#pragma once
// An axis-aligned box.
#include <limits>

#include "rigid/math/types.hpp"

namespace silt::rigid {

struct BoundingBox {
  Vec3 lower, upper;

  static BoundingBox around(const Vec3& centre, const Vec3& half) { return {centre - half, centre + half}; }
  /// It holds no point; `add` makes it grow.
  static BoundingBox empty() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return {Vec3::Constant(infinity), Vec3::Constant(-infinity)};
  }
  static BoundingBox everything() { return {empty().upper, empty().lower}; }
  void add(const BoundingBox& other) {
    lower = lower.cwiseMin(other.lower);
    upper = upper.cwiseMax(other.upper);
  }
};

}  // namespace silt::rigid

#pragma once
// Where cells are fine, and the number of coarser levels.
#include <array>
#include <cstdint>
#include <vector>

#include "rigid/math/types.hpp"

namespace silt::coupler {

/// Cells are refined and coarsened only before steps that are multiples of this.
inline constexpr std::int64_t regrid_interval = 32;

/// A box without cells above a level.
struct FineBox {
  rigid::BoundingBox box{rigid::Vec3::Zero(), rigid::Vec3::Zero()};
  int level = 0;
};

/// Cells of level l are 2^l finest cells wide.
struct CoarseningSpec {
  static constexpr int most_levels = 4;
  static_assert(regrid_interval % (1 << most_levels) == 0);
  int levels = 1;       // number of coarser levels
  double distance = 0;  // cells, from bodies and curved walls, within which cells are finest
  std::vector<FineBox> fine;

  /// Returns the divisor of domain sizes (finest cells) and run intervals (steps).
  int stride() const { return 1 << levels; }
};

}  // namespace silt::coupler

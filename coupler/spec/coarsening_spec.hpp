#pragma once
// Where cells are fine, and how many levels of coarser ones there are.
#include <array>
#include <cstdint>
#include <vector>

#include "rigid/math/types.hpp"

namespace silt::coupler {

/// Cells are refined and coarsened before steps that are multiples of this, and at no other time.
inline constexpr std::int64_t regrid_interval = 16;

/// A box in which no cell is of a higher level.
struct FineBox {
  rigid::BoundingBox box{rigid::Vec3::Zero(), rigid::Vec3::Zero()};
  int level = 0;
};

/// Cells of level l are 2^l finest cells wide.
struct CoarseningSpec {
  static constexpr int most_levels = 4;
  static_assert(regrid_interval % (1 << most_levels) == 0);
  int levels = 1;       // besides the finest, 0
  double distance = 0;  // cells: from bodies and curved walls up to which cells are finest
  std::vector<FineBox> fine;

  /// Finest cells, and steps, of which sizes of the domain and intervals of a run are whole multiples.
  int stride() const { return 1 << levels; }
};

}  // namespace silt::coupler

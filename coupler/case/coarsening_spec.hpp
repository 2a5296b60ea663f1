#pragma once
// Where cells may be coarser: the table [coarsening] of a case. Cells of level l are 2^l finest cells wide.
#include <array>
#include <cstdint>
#include <vector>

#include "rigid/shapes/bounding_box.hpp"

namespace silt::coupler {

struct Case;

/// Cells are refined and coarsened before steps that are multiples of this, and at no other time.
inline constexpr std::int64_t regrid_interval = 16;

/// A box in which no cell is of a higher level.
struct FineBox {
  rigid::BoundingBox box{rigid::Vec3::Zero(), rigid::Vec3::Zero()};
  int level = 0;
};

struct CoarseningSpec {
  static constexpr int most_levels = 4;
  static_assert(regrid_interval % (1 << most_levels) == 0);
  int levels = 1;       // besides the finest, 0
  double distance = 0;  // cells: from bodies, curved walls and fine sides up to which cells are finest
  std::array<bool, 6> fine_sides{};  // by Side
  std::vector<FineBox> fine;

  /// Finest cells, and steps, of which sizes of the domain and intervals of a run are whole multiples.
  int stride() const { return 1 << levels; }
};

/// Returns how many finest cells there must be, in every step, between a surface and the nearest coarser
/// cell: what links read beyond it, up to where it is mapped ahead, and the two cells that a border fills.
int least_margin(const Case&);

}  // namespace silt::coupler

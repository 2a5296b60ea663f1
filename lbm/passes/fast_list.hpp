#pragma once
// The cells that the dense pass found to be too fast, listed on the device.
#include <vector>

#include "device/device.hpp"
#include "lbm/collision/stream_collide.hpp"

namespace silt::lbm {

/// A fast cell of a block of a fluid.
struct FastInBlock {
  int block;
  FastCell at;
};

/// Fast cells in any order, as passes see them; beyond `room` they are only counted.
struct FastList {
  static constexpr unsigned room = 4096;
  FastInBlock* cells;
  unsigned* count;
};
FastList fast_list(Device);
/// Returns the fast cells found since the last call, in any order; waits for all passes.
std::vector<FastInBlock> take_fast_cells(Device);

}  // namespace silt::lbm

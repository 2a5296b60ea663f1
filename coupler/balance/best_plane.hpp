#pragma once
// The plane that divides a part of the domain best between so many ranks below and above it.
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "coupler/balance/work_map.hpp"
#include "lbm/equal_cut.hpp"

namespace silt::coupler {

struct CutPlane {
  int axis = -1, below = 0;                                  // cells of the lower part
  double largest = std::numeric_limits<double>::infinity();  // work a rank in the part that has more of it
  double face = 0;
};

/// Returns the work of items in each layer of cells of a box across each axis, one axis after the other.
std::vector<std::uint64_t> work_of_layers(const lbm::CellBox&, std::span<const WorkItem>);
/// Adds that of the cells, so much each.
void add_cells(const lbm::CellBox&, std::int64_t work_of_a_cell, std::vector<std::uint64_t>& layers);

/// Returns how much more work a side of a plane may have, for a rank of it, that divides as well as the best,
/// or nearly so; what planes one below the other allow multiplies. Bodies without a fluid are exchanged in
/// every sweep: a small face is worth more than even work.
inline double nearly_as_well(std::int64_t work_of_a_cell) {
  return work_of_a_cell > 0 ? 1.01 : 1.05;
}

/// Returns the plane that divides the work best by the numbers of ranks; of those that do it as well, or
/// nearly so, the one with the least face, of several the nearest to where it divides the cells.
CutPlane best_plane(const lbm::CellBox&, const lbm::CutRoom&, std::span<const std::uint64_t> layers,
                    double as_well);

/// Returns an item's parts below and above a plane; their work may be 0.
std::pair<WorkItem, WorkItem> parted(const WorkItem&, int axis, int at);

}  // namespace silt::coupler

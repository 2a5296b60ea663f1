#pragma once
// How evenly ranks that are not there would share the work, found by one process.
#include <vector>

#include "coupler/balance/work_map.hpp"

namespace silt::coupler {

struct WorkShares {
  double largest = 0, mean = 0;  // of a rank, in the units of the items
  double largest_over_mean() const { return mean > 0 ? largest / mean : 1; }
};

/// Returns the work of so many ranks under the cut that weighted_cut would make for them; a rank's items may
/// not be empty of cells, so std::invalid_argument as equal_cut.
WorkShares foreseen_cut(lbm::Int3 cells, std::int64_t work_of_a_cell, std::vector<WorkItem>, int ranks);

/// Returns it under the cut that a domain has.
WorkShares shares_of(const lbm::Domain&, std::int64_t work_of_a_cell, const std::vector<WorkItem>&);

}  // namespace silt::coupler

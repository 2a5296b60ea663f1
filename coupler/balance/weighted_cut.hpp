#pragma once
// Recursive bisection of weighted work (Berger, Bokhari, IEEE Trans. Comput. C-36 (1987) 570), done by the
// ranks together: half of them cut for one part of the domain, half for the other, and so on. No rank ever
// has more than its share of the work items, sums along the edges of its part, and the tree. One process may
// also foresee it for ranks that are not there.
#include <mpi.h>

#include "coupler/balance/work_map.hpp"
#include "lbm/blocks/equal_cut.hpp"

namespace silt::coupler {

struct WorkShares {
  double largest = 0, mean = 0;  // of a rank, in the units of the items
  double largest_over_mean() const { return mean > 0 ? largest / mean : 1; }
};

struct WeightedCut : WorkShares {
  lbm::CutTree tree;
};

/// Collective. Cuts a box of cells into one leaf a rank, of about the same work each: that of its cells, so
/// much each, and of the items, which may lie anywhere on any rank. Of planes that balance as well, or nearly
/// so, that with the least face is taken, where a face across x counts double. Parts have so many cells an
/// edge if there is room. No clock is read: the same items on the same ranks give the same tree.
/// std::invalid_argument as equal_cut.
WeightedCut weighted_cut(MPI_Comm, lbm::Int3 cells, std::int64_t work_of_a_cell, std::vector<WorkItem>,
                         int edge = lbm::usual_edge);

/// Collective. Returns the work of the ranks under the cut that a domain has, if each has its own items.
WeightedCut present_cut(MPI_Comm, const lbm::Domain&, std::int64_t work_of_a_cell,
                        const std::vector<WorkItem>&);

/// Returns the work of so many ranks under the cut that weighted_cut would make for them.
WorkShares foreseen_cut(lbm::Int3 cells, std::int64_t work_of_a_cell, std::vector<WorkItem>, int ranks);

/// Returns it under the cut that a domain has.
WorkShares shares_of(const lbm::Domain&, std::int64_t work_of_a_cell, const std::vector<WorkItem>&);

}  // namespace silt::coupler

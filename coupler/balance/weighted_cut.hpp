#pragma once
// Recursive bisection of weighted work (Berger, Bokhari, IEEE Trans. Comput. C-36 (1987) 570), in parallel:
// half of the ranks divide one part of the domain, half the other, and so on. A rank never has more than its
// share of the work items, sums along the edges of its part, and the tree. One process can predict the cut.
#include <mpi.h>

#include "coupler/balance/body_work.hpp"
#include "lbm/blocks/equal_cut.hpp"

namespace silt::coupler {

struct WorkShares {
  double largest = 0, mean = 0;  // per rank, in the units of the items
  double largest_over_mean() const { return mean > 0 ? largest / mean : 1; }
};

struct WeightedCut : WorkShares {
  lbm::CutTree tree;
};

/// Collective. Cuts a box of cells into one leaf per rank with about equal work: that of its cells,
/// `work_of_a_cell` each, and of the items, which may be anywhere on any rank. Among planes of nearly equal
/// balance it takes that of the least face, where faces across x count double. Parts are at least `edge`
/// cells wide if there is space. The result depends on the items and ranks only, not on run times. Throws
/// std::invalid_argument as equal_cut does.
WeightedCut weighted_cut(MPI_Comm, lbm::Int3 cells, std::int64_t work_of_a_cell, std::vector<WorkItem>,
                         int edge = lbm::usual_edge);

/// Collective. Returns the work of all ranks for the present cut of a domain, given each rank's own items.
WeightedCut present_cut(MPI_Comm, const lbm::Domain&, std::int64_t work_of_a_cell,
                        const std::vector<WorkItem>&);

/// Returns the work for the cut that weighted_cut would make for this number of ranks.
WorkShares foreseen_cut(lbm::Int3 cells, std::int64_t work_of_a_cell, std::vector<WorkItem>, int ranks);

/// Returns the work for the cut that a domain has.
WorkShares shares_of(const lbm::Domain&, std::int64_t work_of_a_cell, const std::vector<WorkItem>&);

}  // namespace silt::coupler

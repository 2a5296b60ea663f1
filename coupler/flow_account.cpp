#include "coupler/flow_account.hpp"

#include "lbm/walls/cut_links.hpp"

namespace silt::coupler {

FlowTotals FlowAccount::totals() const {
  settle();
  FlowSums all = levels_.front()->sums();
  for (std::size_t l = 1; l < levels_.size(); ++l) all.add(levels_[l]->sums());
  return all.over_ranks(comm_);
}

void FlowAccount::end_step(const LinkOutcome& links) {
  out_of_range_ = links.out_of_range;
  wall_loads_ = links.wall_loads;
  brought_.add(links.debts_begun);
  sums_.start(comm_, {links.out_of_range != LinkOutcome::nobody});
}

void FlowAccount::settle() const {
  if (!sums_.under_way()) return;
  if (sums_.finish().ranks_out_of_range > 0)
    throw ForceOutOfRange(parallel::least_over_ranks(comm_, out_of_range_));
}

}  // namespace silt::coupler

#include "coupler/flow_account.hpp"

namespace silt::coupler {

FlowTotals FlowAccount::totals() const {
  settle();
  FlowSums all = levels_.front()->sums();
  for (std::size_t l = 1; l < levels_.size(); ++l) all.add(levels_[l]->sums());
  return all.over_ranks(comm_);
}

FluidMass FlowAccount::mass() const {
  FluidMass all;
  for (const FluidFields* fields : levels_) {
    const FluidMass mass = fields->mass();
    all.cells += mass.cells, all.mass += mass.mass;
  }
  return all;
}

const MassCorrectionState& FlowAccount::mass_correction() const {
  settle();
  return correction_.state();
}

double FlowAccount::begin_pass() {
  settle();
  return corrects_mass_ ? correction_.take_surplus(1 << (levels_.size() - 1)) : 0;
}

void FlowAccount::recount() {
  if (!corrects_mass_) return;
  const auto all = parallel::sum_over_ranks(comm_, StepSums::Recount(mass()));
  correction_.recount(all.mass());
}

void FlowAccount::end_step(const LinkOutcome& links) {
  out_of_range_ = links.out_of_range;
  wall_loads_ = links.wall_loads;
  brought_.add(links.debts_begun);
  const MassCorrection::Gain gain = correction_.take_gain(links.mass_gain);
  StepSums mine{links.out_of_range != LinkOutcome::nobody, gain.cells, gain.link_mass, gain.cell_mass, {}};
  if (corrects_mass_ && correction_.recount_is_due()) mine.recount = mass();
  sums_.start(comm_, mine);
}

/// Takes what the last step left under way.
void FlowAccount::settle() const {
  if (!sums_.under_way()) return;
  const StepSums& all = sums_.finish();
  if (all.ranks_out_of_range > 0) throw ForceOutOfRange(parallel::least_over_ranks(comm_, out_of_range_));
  if (!corrects_mass_) return;
  correction_.end_step({all.link_mass.value(), all.cell_mass.value(), all.cells_gained});
  if (all.recount.ranks > 0) correction_.recount(all.recount.mass());
}

}  // namespace silt::coupler

#include "coupler/flow_account.hpp"

#include <cmath>

#include "lbm/cut_links.hpp"

namespace silt::coupler {
namespace {

/// Steps between two recounts of the fluid, each of which costs as much as some steps.
constexpr std::int64_t recount_interval = 2000;

rigid::FixedSum to_quanta(double mass) {
  return rigid::FixedSum(std::rint(mass / lbm::mass_quantum));
}

}  // namespace

double MassCorrection::take_surplus(int steps_of_coarsest) {
  if (state_.steps % steps_of_coarsest != 0) return source_;
  const rigid::FixedSum surplus = state_.surplus + steps_of_coarsest * state_.link_gain;
  const double cells = double(state_.fluid_cells) * steps_of_coarsest;
  source_ = cells > 0 ? -double(surplus) * lbm::mass_quantum / cells : 0;
  state_.surplus -= surplus;  // to the quantum; the rounding of single cells is not seen
  return source_;
}

void MassCorrection::gain_cells(int cells, double density_deviation) {
  mass_gained_ += cells * to_quanta(density_deviation);
  cells_gained_ += cells;
}

MassCorrection::Gain MassCorrection::take_gain(std::int64_t link_mass) {
  const Gain gain{link_mass, mass_gained_, cells_gained_};
  mass_gained_ = cells_gained_ = 0;
  return gain;
}

bool MassCorrection::recount_is_due() const {
  return (state_.steps + 1) % recount_interval == 0;
}

void MassCorrection::end_step(const Gain& of_all) {
  state_.link_gain = of_all.link_mass;
  // the source was meant for the cells there had been: uncovered ones got it too, covered ones did not
  state_.surplus += of_all.link_mass + of_all.cell_mass + to_quanta(source_ * double(of_all.cells));
  state_.fluid_cells += of_all.cells;
  ++state_.steps;
}

void MassCorrection::recount(const FluidMass& now) {
  state_.surplus = now.mass;
  state_.fluid_cells = std::int64_t(now.cells);
}

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

#include "coupler/mass_correction.hpp"

#include <cmath>

#include "coupler/fluid_fields.hpp"
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

}  // namespace silt::coupler

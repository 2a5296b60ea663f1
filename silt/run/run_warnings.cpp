#include "silt/run/run_warnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lbm/blocks/moments.hpp"
#include "silt/case/case.hpp"
#include "silt/case/case_check.hpp"
#include "silt/simulation.hpp"

namespace silt {

namespace {

std::string doubt_of_sweeps(const Simulation& simulation) {
  constexpr double far = 0.1;
  const Case& setup = simulation.setup();
  const RunCounters counters = simulation.counters();
  const double fall = setup.gravity.norm() / setup.contacts.substeps;
  if (counters.residual <= far * std::max(counters.body_speed, fall)) return "";
  const auto speed = [&](double x) {
    return shown(setup.units.physical(x, dimension::velocity)) + " " +
           setup.units.unit_text(dimension::velocity);
  };
  const int sweeps = setup.contacts.resolver_settings.max_sweeps;
  return fmt::format(
      "contacts.sweeps: the sweeps over the contacts ended far from rest: the last of {} still changed a "
      "body's velocity by {}, where the fastest body had {}; raise contacts.sweeps (--set "
      "contacts.sweeps={}), or take smaller steps",
      sweeps, speed(counters.residual), speed(counters.body_speed), 4 * sweeps);
}

std::string doubt_of_density(const Simulation& simulation) {
  constexpr double doubtful = 0.01;  // a linear pressure drop to the reference exceeds it from 0.017 on
  const Case& setup = simulation.setup();
  const double found = simulation.density_deviation();
  if (found <= doubtful) return "";
  // pressure scales with the square of the speed; another run is checked at other phases of sound waves
  const double factor = std::sqrt(0.8 * doubtful / found);
  return fmt::format(
      "the density of the fluid deviated by up to {:.1f} % (root mean square over its cells); above {} % the "
      "fluid is noticeably compressible: {}",
      100 * found, shown(100 * doubtful),
      setup.units.si ? time_step_cure(setup, factor)
                     : fmt::format("give all velocities times {}", shown(rounded_down(factor))));
}

std::string doubt_of_mass(const Simulation& simulation) {
  constexpr double noticeable = 0.003;
  const double fluid = simulation.initial_balance().fluid_cells;
  const double taken = double(simulation.mass_taken()) * lbm::mass_quantum;
  if (!(std::fabs(taken) > noticeable * fluid)) return "";
  return fmt::format(
      "cells that changed sides where no neighbour was fluid took {:.2f} % of the mass of the fluid: use "
      "smaller cells, for gaps of less than one between bodies",
      100 * taken / fluid);
}

}  // namespace

std::vector<std::string> warnings_of(const Simulation& simulation) {
  std::vector<std::string> doubts{doubt_of_sweeps(simulation)};
  if (simulation.scene().flow)
    doubts.push_back(doubt_of_density(simulation)), doubts.push_back(doubt_of_mass(simulation));
  std::erase(doubts, "");
  return doubts;
}

}  // namespace silt

// Quantities of heat: what flows between fluid and surfaces, temperatures, and what is stored
// (method-heat.md).
#include <numbers>

#include "coupler/exchange/coupling_state.hpp"
#include "lbm/heat/heat_links.hpp"
#include "rigid/math/elementary.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case.hpp"
#include "silt/results/quantity_computation.hpp"

namespace silt {

namespace {

using rigid::ExactSum;

const coupler::CouplingState& state_of(const Simulation& simulation, std::size_t row) {
  return coupler::coupling_of(simulation.bodies(), row);
}

/// Adds the heat that goes into the fluid in a step, in temperatures of a cell.
void add_heat_flow(const Simulation& simulation, const QuantitySpec& q, std::span<ExactSum> sums) {
  const coupler::Flow& flow = *simulation.scene().flow;
  if (q.bearer == Bearer::bodies)
    for_bodies_of(simulation.bodies(), q,
                  [&](std::size_t row) { sums[0].add(-state_of(simulation, row).heat_flow.numbers[0]); });
  if (q.bearer == Bearer::side)
    flow.for_levels([&](const coupler::FluidFields& fields) {
      sums[0].add(-fields.side_heat(q.side / 2, q.side % 2 != 0), lbm::heat_quantum);
    });
  if (q.bearer != Bearer::wall) return;
  const std::size_t sides = simulation.bodies().walls - simulation.setup().walls.size();
  sums[0].add(-flow.heat_of_wall(sides + q.wall), lbm::heat_quantum);
}

double heat_flow(const Case& setup, const QuantitySpec&, std::span<const double> sums) {
  return sums[0] * setup.heat->of_fluid;
}

/// Adds to the heat flow of bodies that of spheres of their volumes and temperatures by a Nusselt number and
/// diffusivity of 1.
void add_nusselt(const Simulation& simulation, const QuantitySpec& q, std::span<ExactSum> sums) {
  add_heat_flow(simulation, q, sums);
  if (q.bearer != Bearer::bodies) return;
  for_bodies_of(simulation.bodies(), q, [&](std::size_t row) {
    const rigid::Shape& shape = simulation.setup().shapes[simulation.bodies().shape[row]];
    const double volume = rigid::mass_properties(shape).volume;
    const double diameter = rigid::elementary::cbrt(volume * 6 / std::numbers::pi);
    sums[1].add(std::numbers::pi * diameter * state_of(simulation, row).temperature.numbers[0]);
  });
}

double nusselt_number(const Case& setup, const QuantitySpec& q, std::span<const double> sums) {
  const coupler::HeatSpec& heat = *setup.heat;
  double conducted = sums[1];
  if (q.bearer == Bearer::side) {
    const auto temperature = [&](int side) { return heat.sides[side].temperature.value_or(0); };
    const int axis = q.side / 2;
    conducted = (temperature(q.side) - temperature(q.side ^ 1)) * setup.cells[(axis + 1) % 3] *
                setup.cells[(axis + 2) % 3] / setup.cells[axis];
  }
  return conducted == 0 ? no_value : sums[0] / (conducted * heat.diffusivity);
}

void add_fluid_temperature(const Simulation& simulation, const QuantitySpec&, std::span<ExactSum> sums) {
  simulation.scene().flow->for_levels([&](const coupler::FluidFields& fields) {
    sums[0].add(fields.heat(), lbm::heat_quantum);
    sums[1].add(double(fields.sums().cells()) * double(fields.volume()));
  });
}

void add_body_temperature(const Simulation& simulation, const QuantitySpec& q, std::span<ExactSum> sums) {
  for_bodies_of(simulation.bodies(), q, [&](std::size_t row) {
    sums[0].add(state_of(simulation, row).temperature.numbers[0]);
    sums[1].add(1.);
  });
}

double mean_temperature(const Case& setup, const QuantitySpec&, std::span<const double> sums) {
  return sums[1] > 0 ? setup.heat->reference + sums[0] / sums[1] : no_value;
}

/// Adds the heat of the fluid, of bodies that have a heat capacity, and what bodies owe the fluid.
void add_stored_heat(const Simulation& simulation, const QuantitySpec&, std::span<ExactSum> sums) {
  simulation.scene().flow->for_levels(
      [&](const coupler::FluidFields& fields) { sums[0].add(fields.heat(), lbm::heat_quantum); });
  const rigid::BodySet& bodies = simulation.bodies();
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    const coupler::BodyHeat& of = simulation.setup().heat->kinds[bodies.kind[row]];
    const coupler::CouplingState& state = state_of(simulation, row);
    sums[0].add(double(state.heat_owed.all) * lbm::heat_quantum);
    if (of.capacity > 0) sums[0].add(of.capacity * bodies.mass[row] * state.temperature.numbers[0]);
  }
}

constexpr Quantity of_heat[] = {
    {"heat-flow", Dimension{2, -3, 1}, Q::bearer | Q::side_bears, Q::fluid | Q::heat,
     in_step({1, add_heat_flow, has_acted}, {of_step<heat_flow>}),
     "heat per time that goes from bodies, a wall or a side of the domain into the fluid, in the last step; "
     "of "
     "bodies over the last steps, in which heat crosses a cell"},
    {"nusselt-number", dimension::none, Q::bearer | Q::side_bears, Q::fluid | Q::heat,
     in_step({2, add_nusselt, has_acted}, {of_step<nusselt_number>}),
     "heat flow of bodies, as if spheres in a fluid of the reference temperature, over π d k ΔT; of a side "
     "over that by conduction to the opposite side; over the same steps"},
    {"mean-temperature", dimension::none, 0, Q::fluid | Q::heat,
     in_step({2, add_fluid_temperature}, {of_step<mean_temperature>}),
     "mean temperature of the fluid, at the end", "K"},
    {"body-temperature", dimension::none, Q::body, Q::fluid | Q::heat | Q::bodies,
     in_step({2, add_body_temperature}, {of_step<mean_temperature>}),
     "mean temperature of the bodies, at the end", "K"},
    {"stored-heat", dimension::energy, 0, Q::fluid | Q::heat,
     in_step({1, add_stored_heat}, {of_step<heat_flow>}),
     "heat of the fluid and of bodies that have a heat capacity, from the reference temperature on, at the "
     "end"},
};

}  // namespace

constinit const std::span<const Quantity> heat_quantities = of_heat;

}  // namespace silt

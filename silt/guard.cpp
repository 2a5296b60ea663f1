#include "silt/guard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "coupler/flow_totals.hpp"
#include "parallel/collectives.hpp"
#include "parallel/together.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case.hpp"
#include "silt/case/case_check.hpp"
#include "silt/scene.hpp"

namespace silt {

using rigid::Vec3;

namespace {

/// Returns the keys that drive motion, at most one per section: "fluid.body_force, bodies[0].velocity".
std::string drives(const Case& setup) {
  constexpr std::array<std::string_view, 7> names = {
      "acceleration", "body_force", "superficial_velocity", "velocity", "angular_velocity",
      "amplitude",    "expansion"};
  std::string listed, last;
  for (const auto& [path, place] : setup.places) {
    const std::string section = path.substr(0, path.find_first_of(".["));
    const auto name = std::string_view(path).substr(path.rfind('.') + 1);
    if (section == last || std::ranges::find(names, name) == names.end()) continue;
    listed += (listed.empty() ? "" : ", ") + path;
    last = section;
  }
  return listed;
}

std::string slower_remedy(const Case& setup) {
  const std::string shorter = shorter_step(setup), driven = drives(setup);
  return fmt::format("{}lower what drives it{}", shorter.empty() ? "" : fmt::format("use {}, or ", shorter),
                     driven.empty() ? "" : fmt::format(" ({})", driven));
}

const char* const light_bodies_remedy = "use coupling.time = \"implicit\" (light bodies need it), or ";

/// Returns what to change when a flow diverges: explicit coupling of light bodies; collision or relaxation
/// time, if close to 1/2, where trt and bgk are unstable; else the time step or the drive.
std::string flow_remedy(const Case& setup) {
  constexpr double delicate_relaxation_time = 0.55;
  if (has_bodies_too_light(setup)) return light_bodies_remedy + slower_remedy(setup);
  const double tau = setup.fluid->relaxation_time;
  if (tau >= delicate_relaxation_time || lbm::model_of(setup.fluid->collision).has_eddies())
    return slower_remedy(setup);
  return fmt::format(
      "the relaxation time is {}, close to its limit of 0.5: use fluid.collision = \"regularised\", or "
      "raise {}",
      shown(tau),
      fmt::format("{}{}", viscosity_key(setup),
                  gives_viscosity(setup) && setup.units.si ? ", or use a smaller units.cell_size" : ""));
}

std::string speed_remedy(const Case& setup, double too_far, std::int64_t step) {
  if (setup.fluid)
    return (setup.coupling.time == coupler::TimeCoupling::explicit_ ? light_bodies_remedy : "") +
           slower_remedy(setup);
  if (step > 0 && rigid::resolver_model(setup.contacts.resolver).makes_energy) return contact_remedy(setup);
  const std::string shorter = shorter_step(setup);
  return fmt::format("beyond that it may pass through others: use contacts.substeps = {:.0f}{}",
                     std::ceil(too_far * setup.contacts.substeps), shorter.empty() ? "" : " or " + shorter);
}

Vec3 centre_of(lbm::Int3 cell) {
  return {cell.x + 0.5, cell.y + 0.5, cell.z + 0.5};
}

/// Returns the distance of a point from the surface of a body or wall, at the nearest periodic image.
double distance_of(const Scene& scene, std::size_t row, Vec3 point) {
  const rigid::Extent& extent = scene.exchange->extent();
  const rigid::Pose pose = scene.bodies.pose(row);
  if (row < scene.bodies.first_wall())
    for (int d = 0; d < 3; ++d)
      if (extent.periodic[d])
        point[d] -= extent.size[d] * std::round((point[d] - pose.position[d]) / extent.size[d]);
  return rigid::signed_distance(scene.world.shapes[scene.bodies.shape[row]], pose.to_body(point));
}

/// A body or wall near a point: its row, and the distance of its surface in cells.
struct Neighbour {
  std::size_t row;
  double distance;
};
struct Neighbours {
  std::optional<Neighbour> first, second;
};
/// Finds the two nearest bodies or walls on this rank within a distance of a cell's centre, in cells.
Neighbours neighbours_of(const Scene& scene, lbm::Int3 cell, double within = 2) {
  Neighbours near;
  for (std::size_t row = 0; row < scene.bodies.size(); ++row) {
    const Neighbour here{row, distance_of(scene, row, centre_of(cell))};
    if (!(here.distance <= within)) continue;
    if (!near.first || here.distance < near.first->distance)
      near.second = near.first, near.first = here;
    else if (!near.second || here.distance < near.second->distance)
      near.second = here;
  }
  return near;
}

/// Returns "cell [1, 2, 3] (at [0.1, 0.2, 0.3] m), 0.6 cells from body 7, in a gap of 1.1 cells to the side
/// z-low", with the position if the case has units, and the neighbours there are.
std::string place_text(const Scene& scene, lbm::Int3 cell, const Neighbours& near) {
  std::string text = fmt::format("cell [{}, {}, {}]", cell.x, cell.y, cell.z);
  if (scene.setup.units.si) {
    const Vec3 x = centre_of(cell) * scene.setup.units.scale(dimension::length);
    text += fmt::format(" (at [{}, {}, {}] m)", shown(x[0]), shown(x[1]), shown(x[2]));
  }
  if (near.first)
    text += fmt::format(", {:.1f} cells from {}", std::max(0.0, near.first->distance),
                        body_name(scene.setup, scene.bodies.id[near.first->row]));
  if (near.second)
    text += fmt::format(", in a gap of {:.1f} cells to {}",
                        std::max(0.0, near.first->distance + near.second->distance),
                        body_name(scene.setup, scene.bodies.id[near.second->row]));
  return text;
}

/// Returns the remedy for fast fluid at a cell: of a body beside it as fast as it, else of the flow.
std::string remedy_at(const Scene& scene, const Neighbours& near, double speed) {
  const rigid::BodySet& bodies = scene.bodies;
  if (!near.first || near.first->row >= bodies.first_wall()) return flow_remedy(scene.setup);
  const std::size_t row = near.first->row;
  const double body = bodies.velocity[row].norm();
  if (body < 0.5 * std::min(speed, highest_speed)) return flow_remedy(scene.setup);
  return fmt::format("the body moves {} cells in a step{}: {}", shown(body), in_si(scene.setup, body),
                     speed_remedy(scene.setup, 1, 0));
}

/// A cell at fault and the fault; the remedy, if it is not that of a flow.
struct FluidFault {
  lbm::Int3 cell;
  std::string what, remedy = {};
};
std::string fluid_text(const Scene& scene, const FluidFault& fault, double speed) {
  const Neighbours near = neighbours_of(scene, fault.cell);
  return fmt::format("the fluid at {}{}; {}", place_text(scene, fault.cell, near), fault.what,
                     fault.remedy.empty() ? remedy_at(scene, near, speed) : fault.remedy);
}

std::string speed_text(const Case& setup, double speed, double limit) {
  return fmt::format(", moves {} cells in a step{}; at most {} is possible", shown(speed),
                     in_si(setup, speed), shown(limit));
}

/// Returns what to change when temperatures grow in flow of this speed.
std::string heat_remedy(const Case& setup, double speed) {
  const std::string waves = doubt_of_heat(setup, speed);
  return waves.empty() ? "use smaller cells, or lower what warms the fluid" : waves;
}

std::string temperature_text(const Case& setup, double temperature, const TemperatureLimits& possible) {
  const double reference = setup.heat->reference;
  if (!std::isfinite(temperature)) return ", has a temperature that is not a number";
  return fmt::format(", has a temperature of {}{}; {} to {} are possible", shown(reference + temperature),
                     setup.units.si ? " K" : "", shown(reference + possible.least),
                     shown(reference + possible.most));
}

std::optional<FluidFault> fault_of_heat(const Case& setup, const coupler::FlowTotals& totals) {
  if (!setup.heat) return {};
  const TemperatureLimits possible = possible_temperatures(setup);
  const auto fault = [&](double temperature, lbm::Int3 cell) {
    return FluidFault{cell, temperature_text(setup, temperature, possible),
                      heat_remedy(setup, totals.max_speed)};
  };
  if (!(totals.max_temperature <= possible.most)) return fault(totals.max_temperature, totals.hottest_cell);
  if (!(totals.min_temperature >= possible.least)) return fault(totals.min_temperature, totals.coldest_cell);
  return {};
}

std::optional<FluidFault> fault_of(const Case& setup, const coupler::FlowTotals& totals) {
  if (!totals.finite) return FluidFault{totals.bad_cell, ", is not a number"};
  if (!(totals.max_speed <= highest_speed))
    return FluidFault{totals.fastest_cell, speed_text(setup, totals.max_speed, highest_speed)};
  if (!(totals.min_density > 0))
    return FluidFault{
        totals.thinnest_cell,
        fmt::format(", has {} of its reference density; it must be above 0", shown(totals.min_density))};
  return fault_of_heat(setup, totals);
}

/// Returns whether this rank has a cell of the finest lattice, or the coarse cell in its place.
bool holds(const coupler::Flow& flow, lbm::Int3 cell) {
  bool found = false;
  flow.for_levels([&](const coupler::FluidFields& fields) {
    for (int b = 0; b < fields.blocks(); ++b) found |= fields.block(b).contains(fields.coarse(cell));
  });
  return found;
}

}  // namespace

void check_flow(const Scene& scene, const coupler::FlowTotals& totals, std::int64_t step) {
  const std::optional<FluidFault> fault = fault_of(scene.setup, totals);
  if (!fault) return;
  const std::string here = holds(*scene.flow, fault->cell) ? fluid_text(scene, *fault, totals.max_speed) : "";
  throw CommonGuardStop(fmt::format("step {}: {}", step, parallel::text_of_first(scene.comm, here)));
}

std::string contact_remedy(const Case& setup) {
  if (rigid::resolver_model(setup.contacts.resolver).makes_energy)
    return fmt::format("contacts.resolver = \"{}\" makes energy where several bodies meet: use \"{}\"",
                       setup.contacts.resolver, rigid::resolver_models().front().name);
  const std::string shorter = shorter_step(setup);
  return fmt::format("raise contacts.substeps (now {}){}", setup.contacts.substeps,
                     shorter.empty() ? "" : ", or use " + shorter);
}

std::string too_fast_text(const Scene& scene, const coupler::FluidFields::Fast& fast, std::int64_t step) {
  const std::string what = std::isfinite(fast.speed)
                               ? speed_text(scene.setup, fast.speed, lbm::speed_of_sound)
                               : ", is not a number";
  return fmt::format("step {}: {}", step, fluid_text(scene, {fast.cell, what}, fast.speed));
}

std::string motion_text(const Case& setup, rigid::BodyId id, double speed, double limit, std::int64_t step) {
  if (!std::isfinite(speed))
    return fmt::format("step {}: position or velocity of body {} is not a number; {}", step, id,
                       setup.fluid ? flow_remedy(setup) : contact_remedy(setup));
  return fmt::format("step {}: body {} moves {} cells in a step{}; at most {} is possible: {}", step, id,
                     shown(speed), in_si(setup, speed), shown(limit),
                     speed_remedy(setup, speed / limit, step));
}

std::string overlap_text(const Case& setup, const rigid::Contact& c, double half_width, bool can_part,
                         std::int64_t step) {
  std::string remedy = contact_remedy(setup);
  if (!rigid::resolver_model(setup.contacts.resolver).makes_energy) {
    const std::string shorter = shorter_step(setup);
    remedy = fmt::format(
        "raise contacts.sweeps (now {}) or contacts.substeps (now {}){}, or use densities that "
        "differ less",
        setup.contacts.resolver_settings.max_sweeps, setup.contacts.substeps,
        shorter.empty() ? "" : ", use " + shorter);
  }
  if (!can_part)
    remedy =
        "no contact can: along a locked axis a body keeps its velocity, whatever is in its way; lower that "
        "velocity, end the run before, or take the axis out of `locked`";
  return fmt::format(
      "step {}: {} and {} overlap by {}{}, deeper than half the width of one ({}), and contacts do not hold "
      "them; {}",
      step, body_name(setup, c.a), body_name(setup, c.b), shown(-c.gap),
      in_si(setup, -c.gap, dimension::length), shown(half_width), remedy);
}

std::string energy_text(const Case& setup, const EnergyGain& e, std::int64_t since, std::int64_t step) {
  const auto shown_energy = [&](double x) {
    return setup.units.si ? fmt::format("{} J", shown(setup.units.physical(x, dimension::energy)))
                          : fmt::format("{} (lattice units)", shown(x));
  };
  return fmt::format(
      "step {}: the energy of the bodies has grown by {} since step {}, though nothing drives them (kinetic "
      "energy now: {}; allowed: {}); {}",
      step, shown_energy(e.gain), since, shown_energy(e.kinetic), shown_energy(e.allowed),
      contact_remedy(setup));
}

std::string border_text(const Case& setup, rigid::BodyId id, std::int64_t step) {
  const coupler::CoarseningSpec& spec = *setup.coarsening;
  return fmt::format(
      "step {}: {} has come within {} cells of coarser ones, where its links would read them; raise "
      "coarsening.distance (now {} cells{}), or {}",
      step, body_name(setup, id), coupler::least_margin(setup.coupling), shown(spec.distance),
      in_si(setup, spec.distance, dimension::length), slower_remedy(setup));
}

std::string overflow_text(const Case& setup, const std::string& what, std::int64_t step,
                          std::optional<int> rank) {
  return fmt::format("step {}: a force is out of range{} ({}); {}", step,
                     rank ? fmt::format(" on rank {}", *rank) : "", what,
                     setup.fluid ? flow_remedy(setup) : contact_remedy(setup));
}

}  // namespace silt

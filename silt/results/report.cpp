#include "silt/results/report.hpp"

#include <sys/resource.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <limits>

#include "coupler/spec/flow_spec.hpp"
#include "coupler/state_hash.hpp"
#include "cpu/isa.hpp"
#include "lbm/walls/cut_links.hpp"
#include "parallel/collectives.hpp"
#include "rigid/math/exact_sum.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/body_turnover.hpp"
#include "silt/case/case.hpp"
#include "silt/case/case_check.hpp"
#include "silt/case/quantity_spec.hpp"
#include "silt/results/build_info.hpp"

namespace silt {

namespace {

using Json = nlohmann::ordered_json;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();  // null in the file

/// The spread of a number over the ranks.
struct Spread {
  double least, mean, most;
  Json json() const { return Json::object({{"min", least}, {"avg", mean}, {"max", most}}); }
};

Spread spread(const Simulation& simulation, double mine) {
  const MPI_Comm comm = simulation.scene().comm;
  double most[2] = {mine, -mine};
  parallel::max_over_ranks(comm, std::span<double>(most));
  return {-most[1], parallel::sum_over_ranks(comm, mine) / simulation.scene().ranks(), most[0]};
}

// ---- present and skipped parts ----

bool has_stage(const Scene& scene, coupler::Stage stage) {
  const bool flow = scene.flow != nullptr;
  if (stage == coupler::Stage::lbm_communication || stage == coupler::Stage::stream_collide) return flow;
  const bool couples = stage == coupler::Stage::object_mapping || stage == coupler::Stage::force_evaluation;
  return couples ? flow && scene.setup.has_surfaces() : scene.rigid_step != nullptr;
}

/// Returns the stages, forces and outputs that the scene skips.
Json skipped_passes(const Scene& scene) {
  const OutputSpec& output = scene.setup.output;
  Json skipped = Json::array();
  const auto skip = [&](bool absent, std::string_view name) {
    if (absent) skipped.push_back(name);
  };
  const auto none = [&](double rigid::Material::*coefficient) {
    return std::all_of(scene.world.materials.begin(), scene.world.materials.end(),
                       [&](const rigid::Material& m) { return m.*coefficient == 0; });
  };
  for (int s = 0; s < int(coupler::Stage::count); ++s)
    skip(!has_stage(scene, coupler::Stage(s)), coupler::stage_names[s]);
  skip(scene.ranks() == 1, "messages between ranks");
  skip(scene.flow && scene.setup.has_surfaces() && !scene.anything_moves, "remapping");
  skip(scene.rigid_step && scene.setup.gravity.isZero(0), "gravity");
  skip(scene.flow && !scene.setup.fluid->has_body_force(), "body force");
  skip(scene.rigid_step && none(&rigid::Material::restitution), "restitution");
  skip(scene.rigid_step && none(&rigid::Material::friction), "friction");
  skip(scene.flow && scene.rigid_step && !scene.world.lubrication, "lubrication");
  skip(output.fields.every == 0, "field output");
  skip(output.bodies.every == 0, "body output");
  skip(output.checkpoint.every == 0, "checkpoints");
  return skipped;
}

/// Returns an object with of(stage) for each stage of the scene's step.
template <class Of>
Json by_stage(const Scene& scene, Of&& of) {
  Json stages = Json::object();
  for (int s = 0; s < int(coupler::Stage::count); ++s)
    if (has_stage(scene, coupler::Stage(s))) stages[coupler::stage_names[s]] = of(s);
  return stages;
}

/// Returns whether momentum is conserved: nothing acts from outside.
bool keeps_momentum(const Scene& scene) {
  const Case& c = scene.setup;
  const auto is_free = [](const BodySpec& b) { return b.motion == rigid::Motion::free && !b.locked; };
  return c.walls.empty() && c.springs.empty() && c.gravity.isZero(0) &&
         !(c.fluid && c.fluid->has_body_force()) && c.periodic(0) && c.periodic(1) && c.periodic(2) &&
         std::all_of(c.bodies.begin(), c.bodies.end(), is_free);
}

/// Returns the shapes with flat faces or edges, which have no lubrication at all.
Json unlubricated_shapes(const Case& setup) {
  Json names = Json::array();
  for (std::size_t s = 0; s < setup.shapes.size(); ++s) {
    const auto parts = rigid::convex_parts(setup.shapes[s]);
    const auto first = setup.shape_names.begin(), own = first + std::ptrdiff_t(s);
    if (std::find(first, own, *own) != own) continue;  // another size
    if (std::none_of(parts.begin(), parts.end(), [](const auto& p) { return rigid::is_smooth(p.shape); }))
      names.push_back(setup.shape_names[s]);
  }
  return names;
}

/// Returns pairs of equivalent diameter and number of bodies, for kinds of several sizes.
Json sizes_of(const Simulation& simulation) {
  const Scene& scene = simulation.scene();
  const Case& setup = scene.setup;
  std::vector<std::uint64_t> counts(setup.shapes.size());
  for (std::size_t row = 0; row < scene.bodies.owned; ++row) ++counts[scene.bodies.shape[row]];
  parallel::sum_over_ranks(scene.comm, std::span(counts));
  Json sizes = Json::object();
  const auto add = [&](const auto& entry) {
    if (entry.sizes.size() == 1) return;
    Json& of_kind = sizes[setup.kind_names[entry.kind]];
    for (const FillSize& size : entry.sizes)
      of_kind.push_back(
          Json::array({setup.units.physical(sphere_of_volume(setup.shapes[size.shape]), dimension::length),
                       counts[size.shape]}));
  };
  std::ranges::for_each(setup.continued, add), std::ranges::for_each(setup.fills, add);
  return sizes;
}

void add_scene(const Simulation& simulation, Json& report) {
  const Scene& scene = simulation.scene();
  const Case& c = scene.setup;
  report["title"] = c.title;
  report["ranks"] = scene.ranks();
  report["blocks"] = scene.domain.blocks();
  report["cells"] = std::uint64_t(c.volume());
  report["bodies"] = simulation.body_count();
  if (c.has_sizes()) report["sizes"] = sizes_of(simulation);
  report["backend"] = scene.backend_name();
  report["resolver"] = scene.resolver_name();
  if (c.fluid) {
    report["collision"] = std::string(coupler::collision_names[c.fluid->collision]);
    report["collision_reason"] = collision_reason(c);
    report["relaxation_time"] = c.fluid->relaxation_time;
    report["precision"] = std::string(coupler::precision_names[c.fluid->precision]);
    report["wall_scheme"] = std::string(coupler::wall_scheme_names[c.coupling.wall_scheme]);
    report["time_coupling"] = std::string(coupler::time_coupling_names[c.coupling.time]);
    report["lubrication"] = nullptr;
    if (const auto& films = scene.world.lubrication)
      report["lubrication"] = {{"reach_cells", films->reach()}, {"shapes_without", unlubricated_shapes(c)}};
    report["force"] = std::string(coupler::force_form_names[c.coupling.force]);
  }
}

void add_balance(Simulation& simulation, Json& report) {
  const Balance& before = simulation.initial_balance();
  const Balance now = simulation.balance();
  const auto of_fluid = [&](double mass) {  // relative to its mass at the start
    return before.fluid_cells > 0 ? mass / before.fluid_cells : unknown;
  };
  report["mass_drift"] = of_fluid(now.mass_deviation - before.mass_deviation);
  report["mass_taken"] = of_fluid(double(simulation.mass_taken()) * lbm::mass_quantum);
  // p - p(0)| / (|p of the fluid| + sum |p of a body|), with the larger of the two scales
  const double scale = std::max(before.momentum_scale, now.momentum_scale);
  report["momentum_drift"] = keeps_momentum(simulation.scene()) && scale > 0
                                 ? (now.momentum - before.momentum).norm() / scale
                                 : unknown;
}

/// Returns the momentum and the kinetic energy (with rotation) of free bodies.
std::array<rigid::ExactSum, 4> motion_of_bodies(const Scene& scene) {
  const rigid::BodySet& rows = scene.bodies;
  std::array<rigid::ExactSum, 4> sums;
  for (std::size_t row = 0; row < rows.owned; ++row) {
    if (!rows.is_dynamic(row)) continue;
    for (int d = 0; d < 3; ++d) sums[d].add(rows.mass[row] * rows.velocity[row][d]);
    sums[3].add(rows.kinetic_energy(row));
  }
  parallel::sum_over_ranks(scene.comm, std::span(sums));
  return sums;
}

void add_motion(const Simulation& simulation, Json& report) {
  const Units& units = simulation.setup().units;
  const Scene& scene = simulation.scene();
  const auto energy = [&](double x) { return units.physical(x, dimension::energy); };
  const auto momentum = [&](auto... p) { return Json::array({units.physical(p, dimension::momentum)...}); };
  const auto [x, y, z, of_bodies] = motion_of_bodies(scene);
  report["energy"] = Json::object({{"bodies", energy(of_bodies.value())}});
  report["momentum"] = Json::object({{"bodies", momentum(x.value(), y.value(), z.value())}});
  if (!scene.flow) return;
  const coupler::FlowTotals flow = scene.flow->totals();
  const auto p = scene.flow->fields().velocity_sum(flow);
  report["energy"]["fluid"] = energy(flow.energy);
  report["momentum"]["fluid"] = momentum(p[0], p[1], p[2]);
}

/// Returns the number of bodies that left, by each open way.
Json left_by(const Case& setup, const RunCounters& counters) {
  Json ways = Json::object();
  for (int side = 0; side < first_outflow; ++side)
    if (setup.boundary[side].removes_bodies()) ways[way_text(side)] = counters.left_by[side];
  if (!setup.outflows.empty()) ways["outflow"] = counters.left_by[first_outflow];
  return ways;
}

void add_counters(const Simulation& simulation, Json& report) {
  const Units& units = simulation.setup().units;
  const RunCounters c = simulation.counters();
  double fastest = std::max(c.body_speed, simulation.fluid_speed());
  if (const coupler::Flow* flow = simulation.scene().flow.get()) {
    const coupler::FlowTotals totals = flow->totals();
    fastest = std::max(fastest, totals.max_speed);
    report["min_density"] = totals.min_density;
    report["max_density"] = totals.max_density;
    report["density_deviation"] = simulation.density_deviation();
    report["fluid_cells"] = totals.fluid_cells;
  }
  report["max_velocity"] = units.physical(fastest, dimension::velocity);
  report["max_velocity_lattice"] = fastest;
  visit_counters(c, [&](const CounterName& name, auto x) {
    if constexpr (std::is_same_v<decltype(x), double>)
      report[name.report] = units.physical(x, name.dimension);
    else if (name.report)
      report[name.report] = x;
  });
  report["bodies_left_by"] = left_by(simulation.setup(), c);
  report["contacts_now"] = simulation.contacts_now();
  report["links"] = simulation.links();
}

/// Returns the cells of each level, finest first, and the time of its passes.
Json levels_of(const Simulation& simulation) {
  const coupler::Flow& flow = *simulation.scene().flow;
  const coupler::StageSeconds stages = simulation.stage_seconds();
  double finest =
      stages[int(coupler::Stage::stream_collide)] + stages[int(coupler::Stage::lbm_communication)];
  for (int level = 1; level < flow.levels(); ++level) finest -= flow.seconds(level);
  Json levels = Json::array();
  flow.for_levels([&](const coupler::FluidFields& fields) {
    std::uint64_t cells = 0;
    for (int b = 0; b < fields.blocks(); ++b) cells += std::uint64_t(fields.block(b).cells());
    const MPI_Comm comm = simulation.scene().comm;
    const double seconds = fields.level() > 0 ? flow.seconds(fields.level()) : finest;
    levels.push_back(Json::object({{"width", fields.width()},
                                   {"cells", parallel::sum_over_ranks(comm, cells)},
                                   {"seconds", parallel::max_over_ranks(comm, seconds)}}));
  });
  return levels;
}

void add_times(const Simulation& simulation, const RunStatus& status, Json& report) {
  const Scene& scene = simulation.scene();
  const double in_steps = parallel::max_over_ranks(scene.comm, simulation.step_seconds());
  const double steps = double(simulation.steps_done() - status.first_step);
  const double done = steps * scene.setup.volume() * 1e-6;
  report["mlups"] = !scene.flow ? unknown : in_steps > 0 ? done / in_steps : 0;
  report["wall_seconds"] = status.wall_seconds;
  report["step_seconds"] = in_steps;
  report["stage_seconds"] =
      by_stage(scene, [&](int s) { return spread(simulation, simulation.stage_seconds()[s]).json(); });
  if (scene.flow && scene.flow->levels() > 1) report["levels"] = levels_of(simulation);
}

/// Returns what a rank sends per step: the mean over ranks; for collectives the maximum.
Json traffic_of(const Simulation& simulation, const parallel::Traffic& mine, double steps) {
  const auto a_step = [&](std::uint64_t n) { return spread(simulation, steps > 0 ? double(n) / steps : 0); };
  return Json::object({{"blocking_collectives_per_step", a_step(mine.blocking_collectives).most},
                       {"messages_per_step", a_step(mine.messages).mean},
                       {"empty_messages", a_step(mine.empty_messages).mean},
                       {"bytes_per_step", a_step(mine.bytes).mean}});
}

/// Returns the bytes and touched pages of all ranks per step; the total of bytes also per present body.
Json bus_of(const Simulation& simulation, double steps) {
  const auto a_step = [&](std::uint64_t bytes) {
    return parallel::sum_over_ranks(simulation.scene().comm, steps > 0 ? double(bytes) / steps : 0);
  };
  const BusBytes& bytes = simulation.bus_bytes_in_steps();
  const double to = a_step(bytes.to_device), from = a_step(bytes.from_device),
               bodies = double(simulation.body_count());
  return Json::object({{"bytes_to_device_per_step", to},
                       {"bytes_from_device_per_step", from},
                       {"bytes_per_body_and_step", bodies > 0 ? (to + from) / bodies : unknown},
                       {"pages_touched_per_step", a_step(bytes.pages)}});
}

/// Returns the balance of the ranks' time in stages without waiting.
Json work_of(const Simulation& simulation) {
  double seconds = 0, waits = 0;
  for (const double stage : simulation.stage_seconds()) seconds += stage;
  for (const parallel::Traffic& stage : simulation.stage_traffic()) waits += stage.waited;
  const Spread work = spread(simulation, seconds - waits);
  return Json::object({{"max_over_mean", work.mean > 0 ? work.most / work.mean : unknown},
                       {"seconds", work.json()},
                       {"wait_seconds", spread(simulation, waits).json()}});
}

/// Returns the balance of predicted work: largest over mean of the ranks.
Json balance_of(const Simulation& simulation) {
  const BalanceRecord record = simulation.balance_record();
  const auto evenness = [](const Evenness& e) { return Json{{"before", e.before}, {"after", e.after}}; };
  return Json::object({{"every", simulation.setup().balance_every},
                       {"looks", record.looks},
                       {"moves", record.moves},
                       {"at_start", evenness(record.at_start)},
                       {"last", evenness(record.last)},
                       {"seconds", parallel::max_over_ranks(simulation.scene().comm, record.seconds)}});
}

void add_parallel(const Simulation& simulation, const RunStatus& status, Json& report) {
  const double steps = double(simulation.steps_done() - status.first_step);
  report["traffic"] = traffic_of(simulation, simulation.traffic_in_steps(), steps);
  report["traffic"]["stages"] = by_stage(simulation.scene(), [&](int s) {
    return traffic_of(simulation, simulation.stage_traffic()[s], steps);
  });
  if (simulation.setup().device != Device::cpu) report["bus"] = bus_of(simulation, steps);
  report["work"] = work_of(simulation);
  report["balance"] = balance_of(simulation);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  report["memory_peak_bytes"] = spread(simulation, 1024.0 * double(usage.ru_maxrss)).json();
}

void add_quantities(const Simulation& simulation, const Quantities& quantities, Json& report) {
  for (const auto& [name, value] : quantities.evaluate(simulation)) report["quantities"][name] = value;
  report["quantities_in_last_step"] = Json::object();
  for (const auto& [name, value] : quantities.in_last_step()) report["quantities_in_last_step"][name] = value;
}

std::string meaning_of(const Case& setup, const QuantitySpec& q) {
  const std::string_view meaning = quantity_type(q.type).meaning;
  if (!q.over) return std::string(meaning);
  const auto time = [&](double steps) { return shown(setup.units.physical(steps, dimension::time)); };
  return fmt::format("{}; here the {} of what it is in the steps from {} to {}", meaning,
                     q.over->deviation ? "standard deviation" : "mean", time(q.over->from), time(q.over->to));
}

Json quantity_types_of(const Case& setup) {
  Json types = Json::object();
  for (const QuantitySpec& q : setup.quantities) {
    const QuantityType& type = quantity_type(q.type);
    const std::string unit =
        type.unit.empty() ? setup.units.unit_text(type.dimension) : std::string(type.unit);
    types[q.name] = Json::object({{"type", type.name}, {"unit", unit}, {"meaning", meaning_of(setup, q)}});
  }
  return types;
}

/// Returns the text; bytes that are not valid UTF-8 become U+FFFD.
std::string text_of(const Json& report) {
  return report.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace

std::string report_of(Simulation& simulation, const Quantities& quantities, const RunStatus& status) {
  const Scene& scene = simulation.scene();
  Json report = Json::object();
  report["exit_reason"] = status.exit_reason;
  if (!status.exit_text.empty()) report["exit_text"] = status.exit_text;
  report["steps"] = simulation.steps_done();
  if (status.first_step > 0) report["resumed_at"] = status.first_step;
  report["time"] = double(simulation.steps_done()) * scene.setup.units.time_step;
  report["units"] = scene.setup.units.si ? "si" : "lattice";
  report["overrides"] = scene.setup.overrides;
  add_scene(simulation, report);
  report["state_hash"] =
      status.state_is_sound && status.at_end ? Json(coupler::hex(simulation.hash())) : Json();
  add_times(simulation, status, report);
  add_parallel(simulation, status, report);
  report["skipped"] = skipped_passes(scene);
  for (const char* name : {"mass_drift", "mass_taken", "momentum_drift"}) report[name] = Json();
  if (status.state_is_sound) add_balance(simulation, report), add_motion(simulation, report);
  add_counters(simulation, report);
  report["quantities"] = Json::object();
  report["quantity_types"] = quantity_types_of(scene.setup);
  if (status.state_is_sound) add_quantities(simulation, quantities, report);
  const adapters::Provenance& build = build_info();
  report["version"] = build.version;
  report["commit"] = build.commit;
  report["compiler"] = build.compiler;
  report["flags"] = build.flags;
  report["libraries"] = build.libraries;
  report["instruction_set"] = std::string(instruction_set());
  const Device device = simulation.setup().device;
  report["device"] = std::string(device_names[std::size_t(device)]);
  if (const std::string card = description(device); !card.empty()) report["card"] = card;
  return text_of(report);
}

std::string last_report(const RunStatus& status, std::int64_t steps, int ranks) {
  return text_of({{"exit_reason", status.exit_reason},
                  {"exit_text", status.exit_text},
                  {"steps", steps},
                  {"ranks", ranks}});
}

}  // namespace silt

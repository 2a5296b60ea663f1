#include "silt/run/run_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numeric>
#include <thread>
#include <variant>

#include "coupler/balance/body_work.hpp"
#include "coupler/balance/weighted_cut.hpp"
#include "coupler/exchange/coupling_state.hpp"
#include "coupler/flow.hpp"
#include "coupler/regions/level_views.hpp"
#include "lbm/fluid.hpp"
#include "rigid/bodies/walls.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case.hpp"
#include "silt/case/case_check.hpp"
#include "silt/placement/place_bodies.hpp"

namespace silt {
namespace {

// Measured on one core (method-parallel.md, "The estimate of a run").
constexpr double overhead_of_a_step = 3e-6, overhead_of_ranks = 60e-6;  // s; the latter with several ranks
constexpr double seconds_of_a_body = 0.4e-6, seconds_of_an_impulse = 0.3e-6;  // per sub-step
constexpr double memory_of_a_rank = 45e6, memory_of_a_body = 1200, memory_of_a_link = 40,
                 memory_of_a_mean = 88;  // bytes
constexpr double file_row_of_a_body = 184, file_buoyancy_of_a_body = 24, file_contacts_of_a_body = 48,
                 file_springs_of_a_body = 48, checkpoint_of_a_body = 600, file_field_of_a_row = 20;  // bytes
constexpr double multireflection_link = 1.27;  // relative to other schemes
// Costs of output in collision steps of one cell in single precision: per cell of a field; per number of it,
// plain or a derivative, with packing; per population in a checkpoint with its checksum; per body there; per
// row of bodies.h5; per cell of a report, of a quantity of the flow, of a stress, of the final hash; per
// first-touched byte.
constexpr double of_a_field_cell = 2.5, of_a_number = 1.8, of_a_derivative = 5.6, of_a_population = 5,
                 of_a_saved_body = 600, of_a_row = 300, of_a_report_cell = 1.2, of_a_flow_cell = 3,
                 of_a_stress_cell = 5, of_a_hashed_cell = 6, of_a_new_byte = 0.07;
// Costs in seconds; the last two per body in a report and in each of its quantities, and per sampled body.
constexpr double seconds_of_a_start = 0.1, seconds_of_a_report = 0.1e-3, seconds_of_a_file = 2e-3,
                 seconds_of_all_rows = 1e-3, seconds_of_a_checkpoint = 20e-3;
constexpr double seconds_of_a_reported_body = 0.3e-6, seconds_of_a_sampled_body = 3e-6;
constexpr double contacts_in_a_bed = 3, contacts_in_fluid = 6;  // per body; in fluid at a solid fraction of 1

/// Measures the seconds per cell and step in single precision on this machine now: the median of five steps
/// of 96^3 cells on one core, which take some tens of milliseconds.
double seconds_of_a_cell() {
  constexpr int edge = 96;
  lbm::Fluid<float> fluid(lbm::Domain({edge, edge, edge}, {}, std::nullopt, 1), {}, MPI_COMM_SELF);
  const auto step = [&] {
    fluid.stream_collide();
    fluid.exchange();
  };
  step();  // allocates the memory
  std::array<double, 5> seconds;
  for (double& one : seconds) {
    const auto begin = std::chrono::steady_clock::now();
    step();
    one = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  std::sort(seconds.begin(), seconds.end());
  return std::max(seconds[seconds.size() / 2], 1e-6) / (double(edge) * edge * edge);
}

/// Returns the cost of a contact of a shape relative to spheres: convex parts meet one by one, flat faces in
/// four points, ellipsoids need a search, meshes meet triangle by triangle (benchmarks mesh_pairs).
double contact_factor(const rigid::Shape& shape) {
  if (std::holds_alternative<rigid::Mesh>(shape)) return 200;
  double dearest = 1;
  const auto parts = rigid::convex_parts(shape);
  for (const rigid::Part& part : parts) {
    const bool searched = std::holds_alternative<rigid::Ellipsoid>(part.shape);
    dearest = std::max(dearest, searched ? 6.5 : rigid::is_smooth(part.shape) ? 1. : 8.);
  }
  return dearest * std::min<double>(double(parts.size()), 4);
}

double contacts_of_a_body(const Case& setup, double solid) {
  if (setup.fluid) return contacts_in_fluid * std::min(1., solid);
  return setup.gravity.norm() > 0 ? contacts_in_a_bed : 0.5;
}

/// The bodies for counting work, with their shapes.
struct Scenery {
  rigid::BodySet bodies;
  rigid::World world;
  double volume = 0;
};

Scenery scenery_of(const Case& setup, std::span<const rigid::BodyRecord> continued) {
  Scenery all;
  const auto shapes = centred_shapes(setup);
  for (const CentredShape& shape : shapes) all.world.shapes.push_back(shape.shape);
  std::size_t row = 0;
  const auto add = [&](const rigid::BodyRecord& body) {
    all.bodies.assign(row++, body);
    all.volume += shapes[body.shape].volume;
  };
  all.bodies.resize(all.bodies.owned = continued.size());
  std::ranges::for_each(continued, add);
  const PlacedBodies placed = place_bodies(setup, coupler::make_domain(setup, 1), MPI_COMM_SELF, &all.bodies);
  all.bodies.resize(all.bodies.owned += placed.size());
  placed.for_each([&](rigid::BodyId id, const BodySpec& body) {
    add(body_record(id, body, shapes[body.shape], setup.fluid.has_value()));
  });
  return all;
}

void add_contacts(const Case& setup, const Scenery& all, const coupler::WorkCosts& costs,
                  coupler::WorkMap& work) {
  const double contacts = contacts_of_a_body(setup, all.volume / setup.volume());
  for (std::size_t row = 0; row < all.bodies.owned; ++row)
    if (all.bodies.motion[row] != rigid::Motion::fixed)
      work.add(all.bodies.position[row],
               std::llround(2 * contacts * contact_factor(all.world.shapes[all.bodies.shape[row]]) *
                            double(costs.impulse)));
}

/// Returns the number of links through curved walls.
double links_of_walls(const Case& setup) {
  double surface = 0;
  for (const CurvedWall& wall : setup.walls) {
    if (const auto* tube = wall.tube()) {
      const rigid::Vec3 size(setup.cells[0], setup.cells[1], setup.cells[2]);
      surface += tube->tube.area(tube->axis, size);
      continue;
    }
    const rigid::TriangleMesh& mesh = *wall.mesh()->mesh.surface;
    for (std::uint32_t t = 0; t < mesh.triangles().size(); ++t) surface += mesh.area_normal(t).norm() / 2;
  }
  return setup.fluid ? coupler::links_of_a_surface * surface : 0;
}

double links_of_bodies(const Case& setup, const Scenery& all) {
  if (!setup.fluid) return 0;
  double links = 0;
  for (std::size_t row = 0; row < all.bodies.owned; ++row) {
    const rigid::Shape& shape = all.world.shapes[all.bodies.shape[row]];
    links +=
        coupler::links_of_a_surface * 6 * rigid::mass_properties(shape).volume / rigid::least_width(shape);
  }
  return links;
}

double times(const SeriesSpec& series, std::int64_t steps, bool at_start) {
  return series.every > 0 ? double((steps - 1) / series.every + 1 + at_start) : 0;
}

double cells_of(const FieldsSpec& fields) {
  double cells = 1;
  for (int d = 0; d < 3; ++d) cells *= fields.upper[d] - fields.lower[d];
  return cells;
}

double bytes_of_fields(const FieldsSpec& fields) {
  double of_a_cell = 0;
  for (const Field field : fields.quantities)
    of_a_cell += field == Field::solid     ? 1
                 : field == Field::body_id ? 8
                                           : numbers_of(field) * (fields.double_precision ? 8 : 4);
  return cells_of(fields) * of_a_cell;
}

double seconds_of_fields(const FieldsSpec& fields, double cell) {
  double steps = 0;
  for (const Field field : fields.quantities)
    steps +=
        of_a_field_cell + numbers_of(field) * (field == Field::vorticity ? of_a_derivative : of_a_number);
  return seconds_of_a_file + cells_of(fields) * steps * cell;
}

/// Returns in how many steps a quantity is computed for its mean and for rows of series.
double steps_computed(const Case& setup, const QuantitySpec& q) {
  const auto steps = double(setup.steps);
  double computed = q.over ? std::max(0., std::min(q.over->to, steps) - q.over->from) : 0;
  for (const ColumnsSpec& series : setup.output.series)
    if (std::ranges::count(series.columns, q.name))
      computed += times(series, setup.steps, false) * double(series.mean_of);
  return std::min(computed, steps);
}

/// Returns the seconds of all output on one rank; `cell` is the time per cell and step in single precision,
/// `share` as in disk_needed.
double seconds_of_output(const Case& setup, double bodies, double cell, double share) {
  const OutputSpec& output = setup.output;
  const double cells = setup.fluid ? share * setup.volume() : 0;
  const int words = setup.fluid && setup.fluid->precision == coupler::Precision::double_ ? 2 : 1;
  double report_cell = words * of_a_report_cell, report_body = seconds_of_a_reported_body, of_means = 0;
  for (const QuantitySpec& q : setup.quantities) {
    if (q.type == "dissipation") report_cell += of_a_flow_cell;
    if (q.type == "viscous-stress")
      of_means +=
          steps_computed(setup, q) * share * (q.box.upper - q.box.lower).prod() * of_a_stress_cell * cell;
    report_body += q.type == "packing-fraction" ? seconds_of_a_sampled_body : seconds_of_a_reported_body;
  }
  const double report = seconds_of_a_report + bodies * report_body + cells * report_cell * cell;
  const double checkpoint =
      seconds_of_a_checkpoint +
      (cells * populations_of(setup) * words * of_a_population + bodies * of_a_saved_body) * cell;
  double seconds = of_means + times(output.report, setup.steps, true) * report +
                   cells * of_a_hashed_cell * cell +
                   times(output.checkpoint, setup.steps, false) * checkpoint;
  if (bodies > 0)
    seconds += times(output.bodies, setup.steps, true) * (seconds_of_all_rows + bodies * of_a_row * cell);
  if (setup.fluid)
    seconds += times(output.fields, setup.steps, true) * seconds_of_fields(output.fields, share * cell);
  for (const FieldsSpec& slice : output.slices)
    seconds += times(slice, setup.steps, true) * seconds_of_fields(slice, share * cell);
  return seconds;
}

/// Returns the cut into levels at the start.
lbm::Domain levels_of(const Case& setup, Scenery all) {
  for (std::size_t row = 0; row < all.bodies.owned; ++row)
    coupler::set_mapping_pose(all.bodies, row, all.bodies.pose(row));
  for (const CurvedWall& wall : setup.walls)
    std::visit([&](const auto& surface) { rigid::add_wall(all.bodies, all.world, surface); }, wall.surface);
  const lbm::CutTree view =
      coupler::LevelViews(setup, entrances_of(setup), cut_for_levels(setup, 1), all.world, MPI_COMM_SELF)
          .view(all.bodies);
  return {view, sides_of(setup), 1};
}

/// Adds the cells of each level, and their work per step with that at their borders.
void add_work_of_levels(const lbm::Domain& levels, std::int64_t work_of_a_cell,
                        std::vector<coupler::WorkItem>& items, RunEstimate& estimate) {
  std::int64_t work = 0;
  for (int k = 0; k < levels.blocks(); ++k) {
    const int level = levels.tree().kinds()[k].level;
    const lbm::CellBox box = levels.tree().leaf(k).box;
    estimate.cells[level] += double(box.cells() >> (3 * level));
    items.push_back({box, std::max<std::int64_t>(1, coupler::work_of_leaf(levels, k, work_of_a_cell))});
    work += items.back().work;
  }
  estimate.cell_updates = double(work) / double(work_of_a_cell);
}

/// Warns of open sides at which cells of different levels meet.
std::vector<Diagnostic> border_warnings(const Case& setup, const lbm::CutTree& levels) {
  std::vector<Diagnostic> warnings;
  for (int side = 0; side < 6; ++side) {
    if (!setup.boundary[side].is_open()) continue;
    lbm::CellBox layer{{}, levels.cells()};
    layer.size[side / 2] = 1;
    if (side % 2) layer.lower[side / 2] = levels.cells()[side / 2] - 1;
    int finest = setup.coarsening->levels, coarsest = 0;
    levels.for_leaves_meeting(layer, [&](const lbm::CutTree::Leaf& leaf) {
      finest = std::min<int>(finest, levels.kinds()[leaf.index].level);
      coarsest = std::max<int>(coarsest, levels.kinds()[leaf.index].level);
    });
    if (finest < coarsest)
      warnings.push_back(
          {Diagnostic::Severity::warning, setup.place("coarsening"),
           fmt::format("coarsening: cells of {} are from {} to {} finest cells wide at the start, and the "
                       "fluid that enters or leaves is disturbed where the width changes: give "
                       "coarsening.fine a box along it, or leave more room before it",
                       side_key(side), 1 << finest, 1 << coarsest)});
  }
  return warnings;
}

/// Adds the levels to the estimate and the work of their cells to `items`. Returns the number of cells
/// relative to finest cells everywhere.
double foresee_levels(const Case& setup, const Scenery& all, std::int64_t work_of_a_cell,
                      std::vector<coupler::WorkItem>& items, RunEstimate& estimate) {
  const lbm::Domain levels = levels_of(setup, all);
  estimate.cells.resize(setup.coarsening->levels + 1);
  add_work_of_levels(levels, work_of_a_cell, items, estimate);
  estimate.doubts = border_warnings(setup, levels.tree());
  return std::accumulate(estimate.cells.begin(), estimate.cells.end(), 0.) / setup.volume();
}

}  // namespace

RunEstimate estimate_run(const Case& setup, std::span<const rigid::BodyRecord> continued, int ranks) {
  const double cell = seconds_of_a_cell();
  coupler::WorkCosts costs(setup, setup.contacts.substeps);
  // Cells are limited by memory, bodies by the CPU, so their ratio depends on the machine.
  const auto in_tenths_of_a_cell = [&](double seconds) { return std::llround(10 * seconds / cell); };
  costs.body = setup.contacts.substeps * in_tenths_of_a_cell(seconds_of_a_body);
  costs.impulse = setup.contacts.substeps * in_tenths_of_a_cell(seconds_of_an_impulse);
  if (lbm::reads_beyond(setup.coupling.wall_scheme))
    costs.link = std::llround(multireflection_link * double(costs.link));
  const Scenery all = scenery_of(setup, continued);
  const std::size_t bodies = all.bodies.owned;
  coupler::WorkMap work(coupler::make_domain(setup, 1));
  add_bodies(all.bodies, costs, work);
  add_surfaces(all.bodies, all.world, costs, work);
  add_contacts(setup, all, costs, work);
  const double wall_links = links_of_walls(setup);
  auto items = work.items();
  const lbm::Domain domain = coupler::make_domain(setup, ranks);
  RunEstimate estimate;
  const double share = setup.coarsening ? foresee_levels(setup, all, costs.cell, items, estimate) : 1;
  if (setup.coarsening) costs.cell = 0;  // items contain the work of cells
  if (const auto found = pressure_warning(setup, all.bodies, all.world)) estimate.doubts.push_back(*found);
  if (const auto found = inlet_warning(setup, all.bodies, all.world, MPI_COMM_SELF))
    estimate.doubts.push_back(*found);
  coupler::WorkShares shares = shares_of(domain, costs.cell, items);
  if (ranks > 1 && !setup.block_cells) {
    const coupler::WorkShares better = foreseen_cut(domain.cells(), costs.cell, items, ranks);
    if (better.largest < shares.largest) shares = better;
  }
  const double of_walls = wall_links * double(costs.link) / ranks;  // their place is not considered
  shares.largest += of_walls, shares.mean += of_walls;
  estimate.ranks = ranks;
  estimate.largest_over_mean = shares.largest_over_mean();
  const double cores = std::max(1u, std::thread::hardware_concurrency());
  const double crowd = std::max(1., ranks / cores);
  estimate.seconds_a_step =
      shares.largest / 10 * cell * crowd + overhead_of_a_step + (ranks > 1 ? overhead_of_ranks : 0);
  estimate.seconds_of_output = seconds_of_output(setup, double(bodies), cell, share) * crowd / ranks;
  const double of_fluid = share * fluid_memory(setup);
  const double start = seconds_of_a_start + of_fluid * of_a_new_byte * cell * crowd / ranks;
  estimate.seconds = start + estimate.seconds_a_step * double(quiet_start_steps(setup) + setup.steps) +
                     estimate.seconds_of_output;
  estimate.memory = of_fluid + memory_of_a_rank * ranks + memory_of_a_body * double(bodies) +
                    memory_of_a_link * (wall_links + links_of_bodies(setup, all)) +
                    (setup.output.mean ? memory_of_a_mean * setup.volume() : 0);
  estimate.disk = disk_needed(setup, bodies, share);
  return estimate;
}

double disk_needed(const Case& setup, std::uint64_t bodies, double share) {
  const OutputSpec& output = setup.output;
  const double n = double(bodies);
  double bytes = times(output.fields, setup.steps, true) * bytes_of_fields(output.fields);
  for (const FieldsSpec& slice : output.slices)
    bytes += times(slice, setup.steps, true) * bytes_of_fields(slice);
  bytes *= share;
  const bool buoyancy = setup.fluid && !setup.gravity.isZero(0);
  const double row = file_row_of_a_body + (buoyancy ? file_buoyancy_of_a_body : 0) +
                     (output.body_contacts ? file_contacts_of_a_body : 0) +
                     (setup.springs.empty() ? 0 : file_springs_of_a_body);
  bytes += times(output.bodies, setup.steps, true) * n * row;
  for (const ColumnsSpec& series : output.series)
    bytes += times(series, setup.steps, true) * file_field_of_a_row * double(series.columns.size() + 2);
  for (const ProbesSpec& probes : output.probes)  // as if one of them is a velocity
    bytes += times(probes, setup.steps, true) * double(probes.points.size()) * file_field_of_a_row *
             double(probes.quantities.size() + 8);
  const double kept = std::min<double>(times(output.checkpoint, setup.steps, false), output.keep_checkpoints);
  const double mean = setup.output.mean ? memory_of_a_mean * setup.volume() : 0;
  return bytes + mean + kept * (share * fluid_memory(setup) + mean + n * checkpoint_of_a_body);
}

}  // namespace silt

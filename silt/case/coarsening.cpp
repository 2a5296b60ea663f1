// [coarsening], and its conflicts with the rest of a case.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rigid/shapes/shape.hpp"
#include "silt/case/case_sections.hpp"

namespace silt {
namespace {

constexpr double least_default_distance = 8;  // cells

bool has_no_distance(const Case& setup) {
  return !keeps_all_fine(setup) && !setup.has_surfaces() &&
         (setup.coarsening->levels == 1 || setup.coarsening->fine.empty());
}
constexpr std::tuple coarsening_keys{
    Key{"levels", &coupler::CoarseningSpec::levels, Whole{1, coupler::CoarseningSpec::most_levels},
        "number of levels of coarser cells; cells and steps of each level are twice as large as those of the "
        "one before",
        required},
    Key{"distance", &coupler::CoarseningSpec::distance, Number{dimension::length, range::above(0)},
        "distance from bodies and curved walls within which cells are finest; cells of level 1 extend twice "
        "as far beyond, and so on",
        "half the largest body, at least 8 cells",
        IdleInCase{has_no_distance, "there are no bodies and no [[walls]] that it is from"}},
    HandKey{"fine", "list of tables", "", "none", "boxes of fine cells"}};
constexpr std::tuple fine_keys{
    Key{"box", &coupler::FineBox::box, Corners{},
        "two corners of a box in which cells are of the level, or finer", required},
    Key{"level", &coupler::FineBox::level, Whole{0, coupler::CoarseningSpec::most_levels - 1},
        "the level: cells 2^level finest cells wide"}};

double default_distance(const Case& setup) {
  double largest = 0;
  if (setup.shapes.empty()) return least_default_distance;
  for (const Entry& entry : entries_of(setup))
    largest = std::max(largest, rigid::bounding_radius(setup.shapes[entry.shape]));
  return std::max(std::ceil(largest), least_default_distance);
}

std::string cells_text(const Case& setup, double n) {
  return setup.units.si ? fmt::format("{} ({} cells)", shown_length(setup, n), shown(n))
                        : shown(n) + " cells";
}

/// Rejects a number of steps that is not a multiple of the stride (default: of the coarsest cells); `unit` is
/// the unit of the key in steps.
void require_whole(Diagnostics& findings, const std::string& key, std::int64_t steps, double unit = 1,
                   std::int64_t stride = 0) {
  const coupler::CoarseningSpec& spec = *findings.setup.coarsening;
  if (stride == 0) stride = spec.stride();
  const std::int64_t below = steps / stride * stride;
  if (below == steps) return;
  const auto said = [&](std::int64_t n) { return shown(static_cast<double>(n) * unit); };
  const std::string units = unit == 1 ? " steps" : fmt::format(" s ({} steps)", steps);
  findings.error(key, "{} is {}{}; with coarsening.levels = {} it must be a multiple of {} steps, as {}{}",
                 key, said(steps), units, spec.levels, stride, below > 0 ? said(below) + " or " : "",
                 said(below + stride));
}

void check_size(Diagnostics& findings) {
  const Case& setup = findings.setup;
  const coupler::CoarseningSpec& spec = *setup.coarsening;
  const int stride = spec.stride();
  for (int d = 0; d < 3; ++d) {
    const int n = setup.cells[d], below = n / stride * stride;
    if (below < n)
      findings.error(
          "domain.size",
          "domain.size[{}] is {}; with coarsening.levels = {} it must be a multiple of {} cells, as {}{}", d,
          cells_text(setup, n), spec.levels, stride, below > 0 ? shown_length(setup, below) + " or " : "",
          shown_length(setup, below + stride));
  }
}

void check_intervals(Diagnostics& findings) {
  const Case& setup = findings.setup;
  const double unit = setup.units.si ? setup.units.time_step : 1;
  if (setup.places.count("run.time"))
    require_whole(findings, "run.time", setup.steps, unit);
  else
    require_whole(findings, "run.steps", setup.steps);
  if (setup.steady) require_whole(findings, "run.steady.every", setup.steady->every);
  require_whole(findings, "run.balance.every", setup.balance_every, 1, coupler::regrid_interval);
  const OutputSpec& output = setup.output;
  const auto require_each = [&](const char* list, const auto& entries) {
    for (std::size_t i = 0; i < entries.size(); ++i)
      require_whole(findings, fmt::format("{}[{}].every", list, i), entries[i].every);
  };
  require_whole(findings, "output.fields.every", output.fields.every);
  require_each("output.slices", output.slices);
  require_each("output.series", output.series);
  require_each("output.probes", output.probes);
  require_whole(findings, "output.bodies.every", output.bodies.every);
  require_whole(findings, "output.checkpoint.every", output.checkpoint.every);
  require_whole(findings, "output.report.every", output.report.every);
  require_each("fill", setup.fills);
  for (std::size_t i = 0; i < setup.quantities.size(); ++i)
    if (const QuantitySpec& q = setup.quantities[i];
        quantity_type(q.type).takes(QuantityType::instant) && std::isfinite(q.time))
      require_whole(findings, fmt::format("quantities[{}].time", i), std::llround(q.time), unit);
}

void check_start(Diagnostics& findings) {
  if (findings.setup.start)
    findings.error(
        "initial.from",
        "initial.from gives all cells of one level, but [coarsening] is given; remove one of them");
}

void check_fine_boxes(Diagnostics& findings) {
  const Case& setup = findings.setup;
  for (std::size_t i = 0; i < setup.coarsening->fine.size(); ++i) {
    const auto& [box, level] = setup.coarsening->fine[i];
    const std::string entry = fmt::format("coarsening.fine[{}]", i);
    if (!lies_in_domain(setup, box, 0))
      findings.error(entry + ".box", "{}.box is {}; it must lie in the domain, {}", entry,
                     shown_box(setup, box), shown_box(setup, box_of(setup)));
    if (level >= setup.coarsening->levels)
      findings.error(entry + ".level", "{}.level is {}; it must be below coarsening.levels, {}", entry, level,
                     setup.coarsening->levels);
  }
}

/// Checks that the distance is about the scale of the flow around a body, at most half its diameter.
void check_layers(Diagnostics& findings) {
  const Case& setup = findings.setup;
  const double nu = setup.fluid->kinematic_viscosity, distance = setup.coarsening->distance;
  for (const Entry& entry : entries_of(setup)) {
    if (!entry.largest) continue;
    const double diameter = sphere_of_volume(setup.shapes[entry.shape]);
    double speed = fastest_given(setup);
    if (entry.is_free())
      speed = std::max(speed, terminal_velocity(diameter, entry.density, setup.gravity.norm(), nu));
    const double reynolds = speed * diameter / nu;
    const double layer = std::min(diameter / std::sqrt(std::max(reynolds, 1.)), diameter / 2);
    if (distance < layer)
      findings.warning("coarsening.distance",
                       "coarsening.distance is {}, but the flow around {} changes over about {} (Reynolds "
                       "number {}): use {} or more",
                       cells_text(setup, distance), entry.key, cells_text(setup, std::ceil(layer)),
                       shown(reynolds), shown_length(setup, std::ceil(layer)));
  }
}

}  // namespace

std::vector<KeySection> coarsening_sections() {
  return {section_of("coarsening", coarsening_keys), section_of("coarsening.fine", fine_keys)};
}

bool keeps_all_fine(const Case& setup) {
  return std::ranges::any_of(setup.coarsening->fine, [&](const coupler::FineBox& fine) {
    return fine.level == 0 && fine.box.lower.maxCoeff() <= 0 &&
           (fine.box.upper - extent_of(setup).size).minCoeff() >= 0;
  });
}

void read_coarsening(TableReader& root, Case& setup) {
  TableReader table = root.table("coarsening");
  if (!table.present()) return;
  coupler::CoarseningSpec& spec = setup.coarsening.emplace();
  spec.distance = default_distance(setup);
  read_keys(table, spec, coarsening_keys);
  for (TableReader& fine : table.tables("fine")) {
    coupler::FineBox& region = spec.fine.emplace_back();
    read_keys(fine, region, fine_keys);
    region.box.upper = snapped(region.box.upper, setup.cells);
  }
}

void find_coarsening_faults(const Case& setup, Diagnostics& findings) {
  if (!setup.coarsening) return;
  const coupler::CoarseningSpec& spec = *setup.coarsening;
  if (!setup.fluid)
    return findings.error(
        "coarsening",
        "coarsening applies to cells of the fluid, but the case has no [fluid]; remove the table");
  if (setup.block_cells)
    findings.error("domain.blocks",
                   "domain.blocks is given, but [coarsening] cuts blocks by itself; remove one of the two");
  if (const int least = coupler::least_margin(setup.coupling) + 1; spec.distance < least)
    findings.error(
        "coarsening.distance",
        "coarsening.distance is {}; it must be at least {}, so that no surface meets coarser cells",
        cells_text(setup, spec.distance), cells_text(setup, least));
  check_size(findings);
  check_intervals(findings);
  check_fine_boxes(findings);
  check_start(findings);
  check_layers(findings);
  look_for_idle_keys(findings, "coarsening.", coarsening_keys);
}

}  // namespace silt

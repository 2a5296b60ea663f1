// Checks bodies, but not the places of given ones: densities, sizes, shapes of the backend, boxes of fills,
// and how bodies arrive and leave.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "adapters/automatic/collision_factory.hpp"
#include "coupler/mapping/endless_cylinder.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case_check.hpp"
#include "silt/case/case_sections.hpp"
#include "silt/case/fill_room.hpp"

namespace silt {
namespace {

constexpr double most_density = 1e9;                             // relative to the fluid
constexpr double low_ratio = 0.02, high_ratio = 50;              // of body to fluid density
constexpr double lightest_fluid = 0.05, heaviest_fluid = 20000;  // kg/m3: hydrogen to mercury

/// Returns ": if bodies[0].density is in g/cm3, write 1120 (kg/m3)", or "".
std::string meant(const Case& setup, const std::string& key, double density) {
  const std::string slip = density_slip(setup, key, density);
  return slip.empty() ? "" : ": " + slip;
}

void warn_of_no_solid(const Case& setup, Diagnostics& findings, const std::string& key, double found) {
  findings.warning(key, "{} is {} kg/m3; solids have {} to {}{}", key, shown(found), lightest_solid,
                   heaviest_solid, meant(setup, key, found));
}

/// Checks the density relative to the fluid; the limit of explicit coupling depends on the shape.
void check_ratio(const Case& setup, Diagnostics& findings, const std::string& key, const Entry& body) {
  const double density = body.density, found = setup.units.physical(density, dimension::density);
  if (density < low_ratio || density > high_ratio)
    findings.warning(key, "{} is {} times the fluid's; the method was measured from {} to {}{}", key,
                     shown(density), low_ratio, high_ratio,
                     setup.units.si ? meant(setup, key, found)
                                    : ": in lattice units densities are relative to the fluid's");
  else if (!is_of_a_solid(found) && !meant(setup, key, found).empty())
    warn_of_no_solid(setup, findings, key, found);
  if (const double least = least_explicit_density(setup, setup.shapes[body.shape]); density < least)
    findings.warning(key,
                     "{} is {} times the fluid's; with coupling.time = \"explicit\" shape '{}' is stable "
                     "from about {} on: use coupling.time = \"implicit\"",
                     key, shown(density), setup.shape_names[body.shape], shown(rounded_up(least)));
}

void check_density(const Case& setup, Diagnostics& findings, const Entry& body) {
  const std::string key = body.key + ".density";
  const double found = setup.units.physical(body.density, dimension::density);
  if (body.density > most_density)
    return findings.error(key,
                          "{} is {} times the fluid's (1000 kg/m3 without a fluid); at most {} is possible: "
                          "lower it, or give the body motion = \"fixed\"",
                          key, shown(body.density), shown(most_density));
  if (!(body.density > 0))
    return findings.error(key, "{} is {}; it must be above 0", key, shown(body.density));
  if (!body.is_free()) return;
  if (setup.fluid)
    check_ratio(setup, findings, key, body);
  else if (setup.units.si && !is_of_a_solid(found))
    warn_of_no_solid(setup, findings, key, found);
}

constexpr double fewest_cells_across = 6;    // at 5 the drag of a dilute array is off by about 1 %
constexpr double fewest_cells_seen = 1;      // a smaller body may lie between cell centres
constexpr double speck = 1e-3, dust = 1e-6;  // relative to the domain's length and volume
constexpr double millimetres = 1000;         // per metre

double longest(const Case& setup) {
  return *std::ranges::max_element(setup.cells);
}

/// Returns "; is it in millimetres? in m it is 0.004" if that would be a valid body in the domain.
std::string in_metres(const Case& setup, double across) {
  const double smaller = across / millimetres;
  if (!setup.units.si || smaller > longest(setup) || (setup.fluid && smaller < fewest_cells_seen)) return "";
  return fmt::format("; is it in millimetres? That would be {} m", shown_length(setup, smaller));
}

/// Returns "use units.cell_size = 0.00025", a cell that is `factor` times as long or less and fits the
/// domain.
std::string cure_of_cells(const Case& setup, double factor) {
  const double cell = setup.units.cell_size;
  const rigid::Vec3 size = cell * extent_of(setup).size;
  const double fitting = fitting_cell(size, std::ceil(size.minCoeff() / (factor * cell) * (1 - unseen)));
  return fitting > 0 ? fmt::format("use units.cell_size = {:.12g}", fitting)
                     : fmt::format("use units.cell_size = {}", shown(rounded_down(cell * factor)));
}

void check_cells_across(const Case& setup, Diagnostics& findings, const Entry& body) {
  const double across = rigid::least_width(setup.shapes[body.shape]), factor = across / fewest_cells_across;
  if (factor >= 1) return;
  const std::string found = fmt::format("{}.shape: shape '{}' is {} cells across", body.key,
                                        setup.shape_names[body.shape], shown(across));
  const std::string cure =
      setup.units.si ? cure_of_cells(setup, factor)
                     : fmt::format("make everything {} times as large", shown(rounded_up(1 / factor)));
  if (across < fewest_cells_seen)
    findings.error(body.key + ".shape", "{}, which the lattice cannot resolve; {}{}", found, cure,
                   setup.units.si ? "" : ", or system = \"si\" if lengths are in m");
  else
    findings.warning(body.key + ".shape", "{}; below {} its drag is inaccurate: {}", found,
                     fewest_cells_across, cure);
}

void check_specks(const Case& setup, Diagnostics& findings, const Entry& body) {
  const rigid::Shape& shape = setup.shapes[body.shape];
  const double across = 2 * rigid::bounding_radius(shape);
  const double volume = std::max(1., double(body.count)) * rigid::mass_properties(shape).volume;
  if (across > speck * longest(setup) || volume > dust * setup.volume()) return;
  findings.warning(body.key + ".shape",
                   "{}.shape: shape '{}' is {} across, the domain {}: is domain.size, or the shape, in the "
                   "unit of length of the case?",
                   body.key, setup.shape_names[body.shape], shown_length(setup, across),
                   shown_length(setup, longest(setup)));
}

/// Shapes of files must be of about the size of the domain. Returns whether they are.
bool check_scales(const Case& setup, Diagnostics& findings) {
  bool good = true;
  for (std::size_t i = 0; i < setup.shapes.size(); ++i) {
    const std::string shape = fmt::format("shapes[{}]", i);
    if (!setup.places.count(shape + ".file")) continue;
    const std::string slip = scale_slip(setup, shape, 2 * rigid::bounding_radius(setup.shapes[i]));
    if (slip.empty()) continue;
    findings.error(shape + ".scale", "{}", slip);
    good = false;
  }
  return good;
}

/// A fixed body may reach beyond the domain, but one that is far larger is doubtful.
void check_reach(const Case& setup, Diagnostics& findings, const Entry& body) {
  constexpr double doubtful = 10;  // times the domain
  const double across = 2 * rigid::bounding_radius(setup.shapes[body.shape]), times = across / longest(setup);
  if (times < doubtful) return;
  findings.warning(body.key + ".shape", "{}.shape: shape '{}' is {} across, {:.0f} times the domain{}",
                   body.key, setup.shape_names[body.shape], shown_length(setup, across), times,
                   in_metres(setup, across));
}

/// Where a body reaches its own periodic image, its ends have the lip of edges, but for cylinders along
/// the axis (method-walls.md).
void check_endless(const Case& setup, Diagnostics& findings, const BodySpec& body) {
  const rigid::Shape& shape = setup.shapes[body.shape];
  const auto parts = rigid::convex_parts(shape);
  rigid::Vec3 periods;
  for (int d = 0; d < 3; ++d) periods[d] = setup.periodic(d) ? setup.cells[d] : 0;
  if (parts.size() != 1 || rigid::is_smooth(parts.front().shape) ||
      coupler::endless_cylinder(shape, body.pose, periods))
    return;
  const rigid::BoundingBox box = rigid::bounding_box(shape, body.pose);
  for (int d = 0; d < 3; ++d)
    if (setup.periodic(d) && box.upper[d] - box.lower[d] > setup.cells[d] - 1)
      findings.warning(fmt::format("bodies[{}].shape", body.entry),
                       "bodies[{}] reaches its own image beyond the periodic side {}, and its ends are edges "
                       "there, which add drag: use a shape of type = \"mesh\", whose edges do not",
                       body.entry, "xyz"[d]);
}

/// A body that moves must find room between the walls, and must not meet itself across a border.
void check_room(const Case& setup, Diagnostics& findings, const Entry& body) {
  const rigid::Shape& shape = setup.shapes[body.shape];
  const double width = rigid::least_width(shape), length = 2 * rigid::bounding_radius(shape);
  const double reach = length + setup.contacts.margin;
  const std::string key = body.key + ".shape";
  for (int d = 0; d < 3; ++d) {
    const bool walls = setup.boundary[2 * d].stops_bodies() && setup.boundary[2 * d + 1].stops_bodies();
    if (walls && width > setup.cells[d] + 2 * start_overlap)
      return findings.error(
          key, "{}: shape '{}' is {} across, but its domain only {} from wall to wall along {}{}", key,
          setup.shape_names[body.shape], shown_length(setup, width), shown_length(setup, setup.cells[d]),
          "xyz"[d], in_metres(setup, width));
  }
  for (int d = 0; d < 3; ++d)
    if (setup.periodic(d) && reach > setup.cells[d])
      findings.error(key,
                     "{}: shape '{}' with its contact margin reaches over {} cells, but the periodic axis {} "
                     "has {}: the body would meet itself; lengthen the axis{}",
                     key, setup.shape_names[body.shape], shown(reach), "xyz"[d], setup.cells[d],
                     in_metres(setup, length));
}

// The use of a shape: the number of bodies, and whether any is free.
struct Use {
  std::int64_t count = 0;
  bool free = false;
};

std::vector<Use> uses_of(const Case& setup) {
  std::vector<Use> uses(setup.shapes.size());
  setup.for_each_given([&](const BodySpec& body, std::uint64_t count) {
    uses[body.shape].count += static_cast<std::int64_t>(count);
    uses[body.shape].free |= body.motion == rigid::Motion::free;
  });
  for (const FillSpec& fill : setup.fills)
    for (const FillSize& size : fill.sizes) {
      uses[size.shape].count +=
          fill.count > 0 && fill.every == 0 ? fill.count : 2;  // 2: several sites or arrivals
      uses[size.shape].free = true;
    }
  return uses;
}

// Checks that the backend supports every pair that can meet.
void check_backend(const Case& setup, Diagnostics& findings) {
  const auto backend = adapters::make_backend(setup.contacts.backend);
  const std::vector<Use> uses = uses_of(setup);
  std::size_t messages = 0;
  const auto check = [&](std::size_t i, const rigid::Shape& other, const std::string& other_name) {
    const auto answers = [&](const rigid::Part& a) {
      const auto parts = rigid::convex_parts(other);
      return std::ranges::all_of(parts,
                                 [&](const rigid::Part& b) { return backend->supports(a.shape, b.shape); });
    };
    const auto parts = rigid::convex_parts(setup.shapes[i]);
    if (messages >= most_messages || std::ranges::all_of(parts, answers)) return;
    ++messages;
    findings.error("contacts.backend",
                   "contacts.backend is \"{}\"; it cannot compute contacts of shape '{}' ({}) with {}: use "
                   "another backend, or a simpler shape (polyhedra of at most some 10000 vertices)",
                   setup.contacts.backend, setup.shape_names[i], rigid::shape_name(setup.shapes[i]),
                   other_name);
  };
  const bool walls = std::ranges::any_of(setup.boundary, &coupler::BoundarySpec::stops_bodies);
  for (std::size_t i = 0; i < uses.size(); ++i) {
    if (uses[i].free && walls) check(i, rigid::HalfSpace{rigid::Vec3::UnitZ()}, "a wall");
    for (std::size_t j = i; j < uses.size(); ++j)
      if ((uses[i].free || uses[j].free) && uses[i].count > 0 && uses[j].count > (i == j))
        check(i, setup.shapes[j],
              fmt::format("shape '{}' ({})", setup.shape_names[j], rigid::shape_name(setup.shapes[j])));
  }
}

/// Rejects a fill whose bounding spheres exceed the densest packing of its box.
void check_fill(const Case& setup, Diagnostics& findings, std::size_t index) {
  constexpr double sampling = 1.1;  // accuracy of the space that walls leave
  const double densest = std::numbers::pi / std::sqrt(18);
  const FillSpec& fill = setup.fills[index];
  const std::string key = fmt::format("fill[{}]", index);
  if (!lies_in_domain(setup, fill.box, start_overlap))
    findings.error(key + ".box", "{}.box is {}; it must lie in the domain, {}", key,
                   shown_box(setup, fill.box), shown_box(setup, box_of(setup)));
  const double volume = mean_volume(setup, fill);
  const double left = CurvedWalls(setup).share_left(fill.box, 0);
  if (left <= 0)
    return findings.error(key + ".box", "{}.box is {}: all of it lies in the solid of walls; move it", key,
                          shown_box(setup, fill.box));
  const double room = std::min(1., sampling * left) * (fill.box.upper - fill.box.lower).prod();
  if (static_cast<double>(fill.count) * volume <= room * densest) return;
  findings.error(key + ".count",
                 "{}.count is {}: the bodies have {} times the volume of their box{}; at most {:.0f} can fit",
                 key, fill.count, shown(static_cast<double>(fill.count) * volume / room),
                 setup.walls.empty() ? "" : fmt::format(", of which walls leave {:.0f} %", 100 * left),
                 std::floor(room * densest / volume));
}

void check_fill_rooms(const Case& setup, Diagnostics& findings) {
  for (std::size_t i = 0; i < setup.fills.size(); ++i) try {
      const double radius = rigid::bounding_radius(setup.shapes[setup.fills[i].shape]);
      if (setup.fills[i].arrangement == Arrangement::random)
        room_for_centres(setup, i, radius);
      else
        lattice_of(setup, i, radius);
    } catch (const CaseError& error) {
      for (const Diagnostic& d : error.diagnostics()) findings.list.push_back(d);
    }
}

bool meet(const rigid::BoundingBox& a, const rigid::BoundingBox& b) {
  return (a.lower.array() < b.upper.array()).all() && (b.lower.array() < a.upper.array()).all();
}

void check_outflow(const Case& setup, Diagnostics& findings, std::size_t index) {
  const rigid::BoundingBox& box = setup.outflows[index].box;
  const std::string key = fmt::format("outflow[{}].box", index);
  const std::string is = fmt::format("{} is {}", key, shown_box(setup, box));
  if (!lies_in_domain(setup, box, 0))
    return findings.error(key,
                          "{}; it must lie in the domain, {}; beyond a side that is not solid_for_bodies "
                          "bodies leave without it",
                          is, shown_box(setup, box_of(setup)));
  for (std::size_t i = 0; i < setup.fills.size(); ++i)
    if (const FillSpec& fill = setup.fills[i]; fill.every > 0 && meet(box, fill.box))
      findings.error(key,
                     "{}; it overlaps fill[{}].box, {}, where bodies enter: they would leave at once; move "
                     "the boxes apart",
                     is, i, shown_box(setup, fill.box));
}

/// The side that a ball of constant velocity leaves through, and the step; infinite if it never leaves.
struct WayOut {
  double step = std::numeric_limits<double>::infinity();
  int side = 0;
};
WayOut way_out(const Case& setup, const BodySpec& body) {
  const double radius = rigid::bounding_radius(setup.shapes[body.shape]);
  WayOut first;
  for (int d = 0; d < 3; ++d) {
    const double v = body.velocity[d], x = body.pose.position[d];
    if (setup.periodic(d) || v == 0) continue;
    const double step = ((v > 0 ? setup.cells[d] - x : x) + radius) / std::abs(v);
    if (step < first.step) first = {step, 2 * d + (v > 0)};
  }
  return first;
}

/// Warns of sizes of a fill with a notable share of the mass but less than one body.
void check_sizes(const Case& setup, Diagnostics& findings, std::size_t index) {
  constexpr double good_part = 0.02;
  const FillSpec& fill = setup.fills[index];
  double mass = 0, lacking = 0, rarest = 1, largest = 0, below = 0;
  for (std::size_t size = 0; size < fill.sizes.size(); ++size) {
    const double share = fill.sizes[size].up_to - below;
    below = fill.sizes[size].up_to;
    const rigid::Shape& shape = setup.shapes[fill.sizes[size].shape];
    const double of_size = share * rigid::mass_properties(shape).volume;
    mass += of_size;
    if (share == 0 || FillApplication(index, 0, size).count(fill) > 0) continue;
    lacking += of_size, rarest = std::min(rarest, share), largest = sphere_of_volume(shape);
  }
  if (fill.count == 0 || fill.every > 0 || !(lacking > good_part * mass)) return;
  const std::string key = fmt::format("fill[{}].count", index);
  findings.warning(key,
                   "{} is {}, too few for every size: there is none with a diameter of {}, although sizes "
                   "that are missing have {:.0f} % of the mass: use {} or more",
                   key, fill.count, shown_length(setup, largest), 100 * lacking / mass,
                   shown(rounded_up(1 / rarest)));
}

/// Reports bodies of prescribed motion that leave the domain, with one message per entry.
void check_prescribed(const Case& setup, Diagnostics& findings) {
  int said_of = -1;
  for (const BodySpec& body : setup.bodies) {
    const WayOut out = way_out(setup, body);
    if (body.motion != rigid::Motion::prescribed || body.entry == said_of ||
        !(out.step < static_cast<double>(setup.steps)))
      continue;
    said_of = body.entry;
    const std::string key = entry_key(body.entry) + ".velocity";
    findings.warning(
        key,
        "{} takes the body out of the domain past {} by step {:.0f} of {}: {}; end the run before, or make "
        "it slower",
        key, coupler::side_names[coupler::Side(out.side)], std::ceil(out.step), setup.steps,
        setup.boundary[out.side].removes_bodies() ? "it is taken out there" : "the run stops there");
  }
}

}  // namespace

void find_density_faults(const Case& setup, Diagnostics& findings) {
  const double density = setup.units.density;
  if (setup.units.si && setup.fluid && (density < lightest_fluid || density > heaviest_fluid))
    findings.warning("fluid.density",
                     "fluid.density is {} kg/m3; fluids have {} (a gas) to {} (mercury), water has 1000",
                     shown(density), lightest_fluid, heaviest_fluid);
  for (const Entry& entry : entries_of(setup))
    if (entry.smallest) check_density(setup, findings, entry);
  for (const Entry& entry : continued_entries_of(setup)) check_density(setup, findings, entry);
}

void find_body_faults(const Case& setup, Diagnostics& findings) {
  if (!setup.has_bodies() || !check_scales(setup, findings)) return;
  for (const Entry& entry : entries_of(setup)) {
    if (entry.smallest && setup.fluid) check_cells_across(setup, findings, entry);
    if (entry.largest && !setup.fluid) check_specks(setup, findings, entry);
    if (entry.largest && entry.motion != rigid::Motion::fixed) check_room(setup, findings, entry);
    if (entry.largest && entry.motion == rigid::Motion::fixed) check_reach(setup, findings, entry);
  }
  if (setup.fluid) {
    for (const Entry& entry : continued_entries_of(setup)) check_cells_across(setup, findings, entry);
    for (const BodySpec& body : setup.bodies)
      if (body.motion == rigid::Motion::fixed) check_endless(setup, findings, body);
  }
  check_backend(setup, findings);
  for (std::size_t i = 0; i < setup.fills.size(); ++i) check_fill(setup, findings, i);
  if (!has_errors(findings.list)) check_fill_rooms(setup, findings);
}

void find_turnover_faults(const Case& setup, Diagnostics& findings) {
  for (std::size_t i = 0; i < setup.outflows.size(); ++i) check_outflow(setup, findings, i);
  check_prescribed(setup, findings);
  if (!setup.outflows.empty() && !setup.has_free_bodies())
    findings.warning("outflow", "outflow: the case has no free bodies, and only free bodies can leave");
  for (std::size_t i = 0; i < setup.fills.size(); ++i) {
    const FillSpec& fill = setup.fills[i];
    check_sizes(setup, findings, i);
    const std::string key = fmt::format("fill[{}].every", i);
    if (fill.every == 0) continue;
    if (fill.every >= setup.steps)
      findings.warning(key, "{} is {}, but the run has {} steps: bodies enter at the start only", key,
                       fill.every, setup.steps);
  }
}

}  // namespace silt

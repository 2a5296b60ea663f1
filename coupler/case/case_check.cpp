#include "coupler/case/case_check.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "coupler/case/body_check.hpp"
#include "coupler/case/case.hpp"
#include "coupler/case/choose_collision.hpp"
#include "coupler/case/derived_table.hpp"
#include "coupler/case/motion_limits.hpp"
#include "coupler/case/quantity_types.hpp"
#include "coupler/case/speed_check.hpp"
#include "coupler/case/turnover_check.hpp"
#include "coupler/case/wall_check.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {
namespace {

// Limits of the method, in lattice units.
constexpr double doubtful_relaxation_low = 0.51, doubtful_relaxation_high = 2;
constexpr double most_magic = 1e3, most_density = 1e9;
constexpr double most_body_force = 0.1, most_gravity = 1;  // cells a step, gained in a step
constexpr double most_steps = 1e15;
constexpr int thinnest_block = 2;  // cells: a block needs a layer to send to either side

double memory_here() {
  return 1. * sysconf(_SC_PHYS_PAGES) * sysconf(_SC_PAGE_SIZE);
}

constexpr const char* side_keys[6] = {"domain.boundary.x[0]", "domain.boundary.x[1]", "domain.boundary.y[0]",
                                      "domain.boundary.y[1]", "domain.boundary.z[0]", "domain.boundary.z[1]"};

void check_domain(const Case& scene, Findings& findings) {
  for (int d = 0; d < 3; ++d) {
    if (scene.cells[d] < 1)
      findings.error("domain.size", fmt::format("the domain has {} cells along {}; it must have at least 1",
                                                scene.cells[d], "xyz"[d]));
    const BoundaryKind low = scene.boundary[2 * d].kind, high = scene.boundary[2 * d + 1].kind;
    if ((low == BoundaryKind::periodic) != (high == BoundaryKind::periodic))
      findings.error(
          fmt::format("domain.boundary.{}", "xyz"[d]),
          fmt::format("domain.boundary.{} is periodic on one side only; a periodic axis has no sides",
                      "xyz"[d]));
    if (!scene.block_cells) continue;
    const int block = (*scene.block_cells)[d];
    if (block < std::min(thinnest_block, scene.cells[d]))
      findings.error("domain.blocks", fmt::format("domain.blocks[{}] is {}; it must be at least {} cells", d,
                                                  block, thinnest_block));
    else if (block > scene.cells[d])
      findings.warning("domain.blocks",
                       fmt::format("domain.blocks[{}] is {} cells; the domain has only {} along {}", d, block,
                                   scene.cells[d], "xyz"[d]));
  }
}

void check_relaxation(const Case& scene, Findings& findings) {
  const double tau = scene.fluid->relaxation_time;
  const char* key = scene.fluid->kinematic_viscosity > 0 && scene.places.count("fluid.kinematic_viscosity")
                        ? "fluid.kinematic_viscosity"
                        : "fluid.relaxation_time";
  if (!(tau > 0.5))
    findings.error(key, fmt::format("the relaxation time is {}; it must be above 0.5 (a viscosity above 0)",
                                    shown(tau)));
  else if (tau < doubtful_relaxation_low && !lbm::model_of(scene.fluid->collision).has_eddies())
    findings.warning(
        key, fmt::format("the relaxation time is {}; below {} runs tend to blow up: use fluid.collision = "
                         "\"regularised\", smaller cells, a longer time step or a higher viscosity",
                         shown(tau), doubtful_relaxation_low));
  else if (tau > doubtful_relaxation_high)
    findings.warning(
        key, fmt::format("the relaxation time is {}; above {} walls and slow flow lose accuracy: shorten "
                         "the time step",
                         shown(tau), doubtful_relaxation_high));
}

void check_cell_reynolds(const Case& scene, Findings& findings) {
  const lbm::Collision model = scene.fluid->collision;
  const double found = cell_reynolds(scene), measured = measured_reynolds(model);
  if (found > measured)
    findings.warning(
        "fluid.collision",
        fmt::format("the cell Reynolds number u/nu is {} at the largest speed given; {} was measured to last "
                    "up to {} (scripts/stability): use {}smaller cells",
                    shown(found), lbm::model_of(model).name, shown(measured),
                    lbm::model_of(model).has_eddies() ? "" : "fluid.collision = \"regularised\" or "));
}

void check_memory(const Case& scene, Findings& findings) {
  constexpr double most_cells = 1e13;  // far beyond the largest machines: a slip of the pen
  const double cells = 1. * scene.cells[0] * scene.cells[1] * scene.cells[2], needed = fluid_memory(scene);
  if (cells > most_cells)
    findings.error("domain.size",
                   fmt::format("the domain has {} cells; at most {} are possible: use larger cells",
                               shown(cells), shown(most_cells)));
  else if (const double here = memory_here(); needed > here)
    findings.warning(
        "domain.size",
        fmt::format("the fluid needs {:.0f} GB, this machine has {:.0f} GB: use larger cells, or several "
                    "machines",
                    needed / 1e9, here / 1e9));
}

void check_fluid(const Case& scene, Findings& findings) {
  if (!scene.fluid) return;
  check_memory(scene, findings);
  check_relaxation(scene, findings);
  check_cell_reynolds(scene, findings);
  if (!(scene.fluid->magic > 0))
    findings.error("fluid.magic",
                   fmt::format("fluid.magic is {}; it must be above 0", shown(scene.fluid->magic)));
  if (scene.fluid->magic > most_magic)
    findings.error("fluid.magic", fmt::format("fluid.magic is {}; at most {} is possible: 0.25 is usual",
                                              shown(scene.fluid->magic), shown(most_magic)));
  if (scene.fluid->initial.type == InitialFlow::taylor_green_3d &&
      (scene.cells[0] != scene.cells[1] || scene.cells[1] != scene.cells[2]))
    findings.error("fluid.initial.type",
                   "fluid.initial.type is \"taylor-green-3d\", whose pressure is known in a cube; make "
                   "domain.size the same along x, y and z");
  const InitialSpec& initial = scene.fluid->initial;
  if (initial.type != InitialFlow::rest)
    check_speed(scene.units, findings, "fluid.initial.velocity", initial.largest_speed());
  if (initial.noise > 0) check_speed(scene.units, findings, "fluid.initial.noise", initial.noise);
  bool inlet = false, outlet = false;
  std::string inlet_key;
  for (int side = 0; side < 6; ++side) {
    const BoundarySpec& boundary = scene.boundary[side];
    if (boundary.kind == BoundaryKind::velocity_inlet || boundary.kind == BoundaryKind::moving)
      check_speed(scene.units, findings, fmt::format("{}.velocity", side_keys[side]),
                  boundary.velocity.norm());
    if (boundary.kind == BoundaryKind::moving && std::abs(boundary.velocity[side / 2]) > 0)
      findings.error(
          fmt::format("{}.velocity", side_keys[side]),
          fmt::format("{} moves through itself: the velocity of a moving wall must have no component along "
                      "{}",
                      side_keys[side], "xyz"[side / 2]));
    if (boundary.kind == BoundaryKind::velocity_inlet) {
      inlet = true;
      inlet_key = side_keys[side];
    }
    if (boundary.kind == BoundaryKind::pressure_outlet) {
      outlet = true;
      if (!(boundary.density > 0.5 && boundary.density < 1.5))
        findings.error(
            fmt::format("{}.density", side_keys[side]),
            fmt::format("{}.density is {} times the fluid's; it must be between 0.5 and 1.5: in this method "
                        "density is pressure",
                        side_keys[side], shown(boundary.density)));
    }
  }
  if (inlet && !outlet)
    findings.error(inlet_key,
                   fmt::format("{} is a velocity-inlet, but no side is a pressure-outlet: the density would "
                               "grow without end; make one side \"pressure-outlet\"",
                               inlet_key));
}

void check_materials(const Case& scene, Findings& findings) {
  for (const rigid::Material& material : scene.pair_materials) {
    if (!(material.restitution >= 0 && material.restitution <= 1))
      findings.error("contacts.restitution", fmt::format("a restitution is {}; it must be between 0 and 1",
                                                         shown(material.restitution)));
    if (!(material.friction >= 0))
      findings.error("contacts.friction",
                     fmt::format("a friction is {}; it must be at least 0", shown(material.friction)));
  }
  if (scene.contacts.margin < 0)
    findings.error("contacts.margin", fmt::format("contacts.margin is {} cells; it must be at least 0",
                                                  shown(scene.contacts.margin)));
}

void check_lubrication(const Case& scene, Findings& findings) {
  if (scene.places.count("coupling.lubrication") && scene.coupling.lubrication && !scene.has_lubrication())
    findings.error("coupling.lubrication",
                   fmt::format("coupling.lubrication is true, but contacts.resolver is '{}', which knows no "
                               "lubrication films; set contacts.resolver = \"sffd\", or remove the key",
                               scene.contacts.resolver));
}

// A body that moves further in a sub-step than contacts reach ahead may be seen only when it overlaps
// another, and one that moves much further, not at all.
void check_margin(const Case& scene, Findings& findings, const std::string& key, double speed, int shape) {
  const double step = speed / scene.contacts.substeps, limit = MotionLimits(scene).of(shape);
  if (!scene.fluid && speed > limit)
    findings.error(
        key, fmt::format("{}: the body moves {} cells in a step; beyond {} it may pass through "
                         "others: raise contacts.substeps to {:.0f}{}",
                         key, shown(speed), shown(limit), std::ceil(speed / limit * scene.contacts.substeps),
                         scene.units.si ? ", or use a smaller units.time_step" : ""));
  else if (step > scene.contacts.margin)
    findings.warning(
        key,
        fmt::format("{}: the body moves {} cells in a sub-step, but contacts.margin is {}: it may overlap "
                    "others; raise contacts.margin or contacts.substeps",
                    key, shown(step), shown(scene.contacts.margin)));
}

/// What drives the scene, against what a single step can take.
void check_driving(const Case& scene, Findings& findings) {
  const auto check = [&](const char* key, double gained, double most) {
    if (gained > most)
      findings.error(
          key, fmt::format("{} adds {} cells a step to a velocity in every step; at most {} is possible: "
                           "shorten the time step, or lower it",
                           key, shown(gained), shown(most)));
  };
  if (scene.fluid) check("fluid.body_force", scene.fluid->body_force.cwiseAbs().maxCoeff(), most_body_force);
  check("gravity.acceleration", scene.gravity.cwiseAbs().maxCoeff(), most_gravity);
}

void check_density(Findings& findings, const std::string& entry, double density) {
  if (density > most_density)
    findings.error(
        entry + ".density",
        fmt::format("{}.density is {} times the fluid's (units.density without a fluid); at most {} is "
                    "possible: lower it, or give the body motion = \"fixed\"",
                    entry, shown(density), shown(most_density)));
}

void check_body_speeds(const Case& scene, Findings& findings) {
  std::vector<int> seen;
  scene.for_each_given([&](const BodySpec& body, std::uint64_t) {
    if (std::count(seen.begin(), seen.end(), body.entry)) return;  // one message an entry
    seen.push_back(body.entry);
    const double rim = rigid::bounding_radius(scene.shapes[body.shape]) * body.angular_velocity.norm();
    const std::string entry = fmt::format("bodies[{}]", std::max(0, body.entry));
    check_density(findings, entry, body.density);
    check_margin(scene, findings, entry + ".velocity", body.velocity.norm(), body.shape);
    if (!scene.fluid) return;
    check_speed(scene.units, findings, entry + ".velocity", body.velocity.norm());
    if (rim > 0) check_speed(scene.units, findings, entry + ".angular_velocity", rim);
  });
}

void check_fill_speeds(const Case& scene, Findings& findings) {
  for (std::size_t i = 0; i < scene.fills.size(); ++i) {
    const std::string key = fmt::format("fill[{}].velocity", i);
    const double speed = scene.fills[i].velocity.norm();
    check_margin(scene, findings, key, speed, scene.fills[i].shape);
    if (scene.fluid) check_speed(scene.units, findings, key, speed);
  }
}

void check_steady(const Case& scene, Findings& findings) {
  constexpr int looks_needed = 4;
  if (!scene.steady) return;
  std::vector<std::string> names;
  for (const QuantitySpec& quantity : scene.quantities) names.push_back(quantity.name);
  const std::string& name = scene.steady->quantity;
  if (std::find(names.begin(), names.end(), name) == names.end())
    findings.error("run.steady.quantity",
                   fmt::format("run.steady.quantity: there is no quantity '{}' in [[quantities]]{}", name,
                               names.empty() ? "" : suggestion(name, names)));
  if (scene.steady->every > scene.steps / looks_needed)
    findings.warning("run.steady.every",
                     fmt::format("run.steady.every is {}, of {} steps in all: there will be less than the {} "
                                 "looks it takes to see that something is steady",
                                 scene.steady->every, scene.steps, looks_needed));
}

void check_run(const Case& scene, Findings& findings) {
  if (scene.steps < 1)
    findings.error("run.steps", fmt::format("the run has {} steps; it must have at least 1", scene.steps));
  if (static_cast<double>(scene.steps) > most_steps)
    findings.error("run.steps", fmt::format("the run has {} steps; at most {} are possible: shorten it",
                                            scene.steps, shown(most_steps)));
  check_driving(scene, findings);
  for (std::size_t i = 0; i < scene.fills.size(); ++i)
    check_density(findings, fmt::format("fill[{}]", i), scene.fills[i].density);
  check_steady(scene, findings);
  if (!scene.fluid && !scene.has_bodies())
    findings.error("", "the case has neither a [fluid] nor bodies: there is nothing to compute");
  if (!scene.fluid && !scene.output.slices.empty())
    findings.error("output.slices",
                   "output.slices asks for fields of the fluid, but the case has no [fluid]; remove it");
  if (!scene.fluid && scene.output.fields.every > 0)
    findings.error("output.fields",
                   "output.fields asks for fields of the fluid, but the case has no [fluid]; remove it");
  if (!scene.has_bodies() && scene.output.bodies.every > 0)
    findings.warning("output.bodies", "output.bodies asks for bodies, but the case has none");
}

void check_sampled_box(const Case& scene, Findings& findings, const QuantitySpec& quantity,
                       const std::string& key) {
  for (int d = 0; d < 3; ++d)
    if (quantity.lower[d] < 0 || quantity.upper[d] > scene.cells[d])
      return findings.error(
          key, fmt::format("{} reaches from {} to {} along {}; it must lie in the domain, 0 to {}", key,
                           shown(quantity.lower[d] * scene.units.cell_size),
                           shown(quantity.upper[d] * scene.units.cell_size), "xyz"[d],
                           shown(scene.cells[d] * scene.units.cell_size)));
}

// What a quantity needs and the scene has not.
std::string lacking(const Case& scene, const QuantityType& type) {
  using Q = QuantityType;
  if (type.asks_for(Q::fluid) && !scene.fluid) return "the case has no [fluid]";
  if (type.asks_for(Q::bodies) && !scene.has_bodies()) return "the case has no bodies";
  if (type.asks_for(Q::gravity) && scene.gravity.norm() == 0) return "the case has no [gravity]";
  const bool driven =
      scene.any_given([](const BodySpec& b) { return b.motion == rigid::Motion::prescribed; });
  if (type.asks_for(Q::same_bodies) && (scene.bodies_come() || scene.bodies_leave()))
    return "bodies come or leave, of which it knows nothing";
  if (type.asks_for(Q::undriven) && driven)
    return "the case has a body of prescribed motion, which drives the others";
  return "";
}

bool is_wall(const BoundarySpec& side) {
  return side.kind == BoundaryKind::no_slip || side.kind == BoundaryKind::moving;
}

void check_side(const Case& scene, Findings& findings, const QuantitySpec& quantity, const std::string& key) {
  if (is_wall(scene.boundary[quantity.side])) return;
  findings.error(key, fmt::format("{} is {}, which is no wall; it must be a side that is no-slip or moving",
                                  key, side_keys[quantity.side]));
}

void check_shear(const Case& scene, Findings& findings, const QuantitySpec& quantity,
                 const std::string& key) {
  const BoundarySpec &low = scene.boundary[2 * quantity.axis], &high = scene.boundary[2 * quantity.axis + 1];
  if (is_wall(low) && is_wall(high) && low.velocity != high.velocity) return;
  findings.error(key, fmt::format("{} is {}, across which nothing is sheared; both sides there must be walls "
                                  "(no-slip or moving), of different velocities",
                                  key, "xyz"[quantity.axis]));
}

void check_quantities(const Case& scene, Findings& findings) {
  for (std::size_t i = 0; i < scene.quantities.size(); ++i) {
    const QuantitySpec& quantity = scene.quantities[i];
    const QuantityType& type = quantity_type(quantity.type);
    const std::string entry = fmt::format("quantities[{}]", i), lack = lacking(scene, type);
    if (!lack.empty())
      findings.error(entry + ".type", fmt::format("{}.type is \"{}\", but {}", entry, quantity.type, lack));
    const bool never = type.takes(QuantityType::time)
                           ? quantity.time >= static_cast<double>(scene.steps)
                           : type.takes(QuantityType::instant) && std::isfinite(quantity.time) &&
                                 quantity.time > static_cast<double>(scene.steps);
    if (never)
      findings.warning(
          entry + ".time",
          fmt::format("{}.time is not before the end of the run: the quantity will have no value", entry));
    if (type.takes(QuantityType::side)) check_side(scene, findings, quantity, entry + ".side");
    if (type.asks_for(QuantityType::sheared)) check_shear(scene, findings, quantity, entry + ".axis");
    if (type.takes(QuantityType::box)) check_sampled_box(scene, findings, quantity, entry + ".box");
  }
}

}  // namespace

std::vector<Diagnostic> check_case(const Case& scene) {
  Findings findings(scene);
  check_domain(scene, findings);
  check_fluid(scene, findings);
  check_materials(scene, findings);
  check_lubrication(scene, findings);
  check_run(scene, findings);
  check_quantities(scene, findings);
  check_body_speeds(scene, findings);
  check_fill_speeds(scene, findings);
  find_wall_faults(scene, findings);
  if (std::all_of(scene.cells.begin(), scene.cells.end(), [](int n) { return n > 0; }))
    find_body_faults(scene, findings), find_turnover_faults(scene, findings);
  return std::move(findings.list);
}

std::vector<Diagnostic> require_runnable(const Case& scene) {
  std::vector<Diagnostic> list = check_case(scene);
  if (!has_errors(list)) return list;
  std::erase_if(list, [](const Diagnostic& d) { return d.severity == Diagnostic::Severity::warning; });
  throw CaseError(std::move(list));
}

}  // namespace silt::coupler

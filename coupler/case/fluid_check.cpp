#include "coupler/case/fluid_check.hpp"

#include <fmt/format.h>

#include "coupler/case/case.hpp"
#include "coupler/case/choose_collision.hpp"
#include "coupler/case/derived_table.hpp"
#include "coupler/case/speed_check.hpp"
#include "coupler/case/time_step_cure.hpp"

namespace silt::coupler {
namespace {

// Limits of the method, in lattice units.
constexpr double doubtful_relaxation_low = 0.51, doubtful_relaxation_high = 2, high_relaxation = 5;
constexpr double most_relaxation = 1e4, usual_relaxation = 1;
constexpr double least_measured = 1e-4;  // of tau - 1/2, by any collision model (scripts/stability)
constexpr double most_magic = 1e3;
// m2/s: of fluids from liquid metal to honey
constexpr double thinnest = 5e-8, thickest = 0.5;

const char* viscosity_key(const Case& scene) {
  return scene.fluid->kinematic_viscosity > 0 && scene.places.count("fluid.kinematic_viscosity")
             ? "fluid.kinematic_viscosity"
             : "fluid.relaxation_time";
}

/// How to get a relaxation time of 1.
std::string shorter_steps(const Case& scene) {
  const double factor = (usual_relaxation - 0.5) / (scene.fluid->relaxation_time - 0.5);
  if (scene.units.si && scene.places.count("fluid.kinematic_viscosity")) return time_step_cure(scene, factor);
  const bool time = scene.places.count("fluid.relaxation_time");
  return fmt::format("use {} = {}", viscosity_key(scene),
                     shown(time ? usual_relaxation : factor * scene.fluid->kinematic_viscosity));
}

void check_thick(const Case& scene, Findings& findings, double tau) {
  const std::string found = fmt::format("the relaxation time is {}", shown(tau));
  const std::string doubt =
      tau > high_relaxation
          ? fmt::format(
                ", and if the viscosity is meant, it is too large for this time step by a factor of {}",
                shown(rounded_up((tau - 0.5) / (usual_relaxation - 0.5))))
          : "";
  if (tau > most_relaxation)
    findings.error(viscosity_key(scene), fmt::format("{}; at most {} is possible: {}{}", found,
                                                     shown(most_relaxation), shorter_steps(scene), doubt));
  else
    findings.warning(viscosity_key(scene),
                     fmt::format("{}; above {} walls and slow flow lose accuracy: {}{}", found,
                                 doubtful_relaxation_high, shorter_steps(scene), doubt));
}

void check_relaxation(const Case& scene, Findings& findings) {
  const double tau = scene.fluid->relaxation_time;
  const char* key = viscosity_key(scene);
  if (!(tau > 0.5))
    findings.error(key, fmt::format("the relaxation time is {}; it must be above 0.5 (a viscosity above 0)",
                                    shown(tau)));
  else if (tau - 0.5 < least_measured)
    findings.warning(
        key, fmt::format("the relaxation time is 0.5 + {}; no collision model was measured below 0.5 + {}: "
                         "the viscosity is too small for these cells by a factor of {}",
                         shown(tau - 0.5), least_measured, shown(rounded_up(least_measured / (tau - 0.5)))));
  else if (tau < doubtful_relaxation_low && !lbm::model_of(scene.fluid->collision).has_eddies())
    findings.warning(
        key, fmt::format("the relaxation time is {}; below {} runs tend to blow up: use fluid.collision = "
                         "\"regularised\", smaller cells, a longer time step or a higher viscosity",
                         shown(tau), doubtful_relaxation_low));
  else if (tau > doubtful_relaxation_high)
    check_thick(scene, findings, tau);
}

void check_viscosity(const Case& scene, Findings& findings) {
  const double found = scene.units.physical(scene.fluid->kinematic_viscosity, dimension::viscosity);
  if (!scene.units.si || (found >= thinnest && found <= thickest)) return;
  findings.warning(viscosity_key(scene),
                   fmt::format("the kinematic viscosity is {} m2/s; fluids have {} (a liquid metal) to {} "
                               "(thick syrup), water has 1e-06, which is 1 mm2/s",
                               shown(found), shown(thinnest), shown(thickest)));
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

void check_cells(const Case& scene, Findings& findings) {
  constexpr double most_cells = 1e13;  // far beyond the largest machines: a slip of the pen
  const double cells = 1. * scene.cells[0] * scene.cells[1] * scene.cells[2];
  if (cells > most_cells)
    findings.error("domain.size",
                   fmt::format("the domain has {} cells; at most {} are possible: use larger cells",
                               shown(cells), shown(most_cells)));
}

void check_magic(const Case& scene, Findings& findings) {
  const double magic = scene.fluid->magic;
  if (!(magic > 0))
    findings.error("fluid.magic", fmt::format("fluid.magic is {}; it must be above 0", shown(magic)));
  if (magic > most_magic)
    findings.error("fluid.magic", fmt::format("fluid.magic is {}; at most {} is possible: 0.25 is usual",
                                              shown(magic), shown(most_magic)));
}

void check_initial(const Case& scene, Findings& findings) {
  const InitialSpec& initial = scene.fluid->initial;
  if (initial.type == InitialFlow::taylor_green_3d &&
      (scene.cells[0] != scene.cells[1] || scene.cells[1] != scene.cells[2]))
    findings.error("fluid.initial.type",
                   "fluid.initial.type is \"taylor-green-3d\", whose pressure is known in a cube; make "
                   "domain.size the same along x, y and z");
  if (initial.type != InitialFlow::rest)
    check_speed(findings, "fluid.initial.velocity", initial.largest_speed());
  if (initial.noise > 0) check_speed(findings, "fluid.initial.noise", initial.noise);
}

}  // namespace

void find_fluid_faults(const Case& scene, Findings& findings) {
  if (!scene.fluid) return;
  check_cells(scene, findings);
  check_relaxation(scene, findings);
  check_viscosity(scene, findings);
  check_cell_reynolds(scene, findings);
  check_magic(scene, findings);
  check_initial(scene, findings);
}

}  // namespace silt::coupler

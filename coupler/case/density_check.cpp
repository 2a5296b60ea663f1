#include "coupler/case/density_check.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "coupler/case/body_text.hpp"
#include "coupler/case/case.hpp"
#include "coupler/case/explicit_limit.hpp"
#include "coupler/case/time_step_cure.hpp"

namespace silt::coupler {
namespace {

constexpr double most_density = 1e9;                 // times the fluid's
constexpr double low_ratio = 0.02, high_ratio = 50;  // of a body's density and the fluid's
// kg/m3: of solids from foam to osmium, of fluids from hydrogen to mercury
constexpr double lightest_solid = 10, heaviest_solid = 25000, lightest_fluid = 0.05, heaviest_fluid = 20000;
constexpr double cubic_centimetres = 1000;  // kg/m3 in g/cm3

bool is_of_a_solid(double density) {
  return density >= lightest_solid && density <= heaviest_solid;
}

/// What the density was perhaps meant to be; both in kg/m3.
std::string meant(const std::string& key, double density, double fluid) {
  if (is_of_a_solid(density * cubic_centimetres) && !is_of_a_solid(density))
    return fmt::format(": if {} is in g/cm3, write {} (kg/m3)", key, shown(density * cubic_centimetres));
  if (is_of_a_solid(fluid * cubic_centimetres) && is_of_a_solid(density))
    return fmt::format(": if fluid.density is in g/cm3, write {} (kg/m3)", shown(fluid * cubic_centimetres));
  if (!is_of_a_solid(density) && is_of_a_solid(density / cubic_centimetres))
    return fmt::format(": {} kg/m3 would be that of a solid", shown(density / cubic_centimetres));
  return "";
}

void check_ratio(const Case& scene, Findings& findings, const std::string& key, double density) {
  if (density >= low_ratio && density <= high_ratio) return;
  const std::string found = fmt::format("{} is {} times the fluid's; the method was measured from {} to {}",
                                        key, shown(density), low_ratio, high_ratio);
  if (scene.units.si)
    return findings.warning(
        key, found + meant(key, scene.units.physical(density, dimension::density), scene.units.density));
  findings.warning(key, found + ": in lattice units densities are relative to the fluid's");
}

void check_matter(const Case& scene, Findings& findings, const std::string& key, double density) {
  const double found = scene.units.physical(density, dimension::density);
  if (!scene.units.si || is_of_a_solid(found)) return;
  findings.warning(key, fmt::format("{} is {} kg/m3; solids have {} to {}{}", key, shown(found),
                                    lightest_solid, heaviest_solid, meant(key, found, 0)));
}

/// The lightest density that explicit coupling bears depends on the shape.
void check_coupling(const Case& scene, Findings& findings, const std::string& key, double density,
                    int shape) {
  const double least = least_explicit_density(scene, scene.shapes[shape]);
  if (density >= least) return;
  findings.warning(key,
                   fmt::format("{} is {} times the fluid's; with coupling.time = \"explicit\" shape '{}' is "
                               "stable from about {} on: use coupling.time = \"implicit\"",
                               key, shown(density), scene.shape_names[shape], shown(rounded_up(least))));
}

void check_density(const Case& scene, Findings& findings, const std::string& entry, double density, int shape,
                   bool free) {
  const std::string key = entry + ".density";
  if (density > most_density)
    return findings.error(
        key, fmt::format("{} is {} times the fluid's (units.density without a fluid); at most {} is "
                         "possible: lower it, or give the body motion = \"fixed\"",
                         key, shown(density), shown(most_density)));
  if (!free || !(density > 0)) return;
  if (scene.fluid)
    check_ratio(scene, findings, key, density), check_coupling(scene, findings, key, density, shape);
  else
    check_matter(scene, findings, key, density);
}

void check_fluid_density(const Case& scene, Findings& findings) {
  const double density = scene.units.density;
  if (!scene.units.si || !scene.fluid || (density >= lightest_fluid && density <= heaviest_fluid)) return;
  findings.warning(
      "fluid.density",
      fmt::format("fluid.density is {} kg/m3; fluids have {} (a gas) to {} (mercury), water has 1000",
                  shown(density), lightest_fluid, heaviest_fluid));
}

}  // namespace

void find_density_faults(const Case& scene, Findings& findings) {
  check_fluid_density(scene, findings);
  std::vector<int> seen;
  scene.for_each_given([&](const BodySpec& body, std::uint64_t) {
    if (std::count(seen.begin(), seen.end(), body.entry)) return;  // one message an entry
    seen.push_back(body.entry);
    check_density(scene, findings, entry_key(std::max(0, body.entry)), body.density, body.shape,
                  body.motion == rigid::Motion::free);
  });
  for (std::size_t i = 0; i < scene.fills.size(); ++i)
    check_density(scene, findings, fmt::format("fill[{}]", i), scene.fills[i].density, scene.fills[i].shape,
                  true);
}

}  // namespace silt::coupler

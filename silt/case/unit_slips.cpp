
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "silt/case/case.hpp"
#include "silt/case/case_check.hpp"

namespace silt {
namespace {

constexpr double cubic_centimetres = 1000;                // kg/m3 in g/cm3
constexpr double of_the_earth = 9.81;                     // m/s2
constexpr double least_excess = 1e-3, most_excess = 1.5;  // of tau - 1/2 in sound runs

bool is_of_the_earth(double gravity) {
  return std::abs(gravity / of_the_earth - 1) < 0.02;
}

bool is_of_a_fluid(double viscosity) {
  return viscosity >= thinnest && viscosity <= thickest;
}

double gravity_of(const Case& setup) {
  return setup.units.physical(setup.gravity.norm(), dimension::acceleration);
}

/// A unit of length.
struct SmallLength {
  const char* name;
  double in_a_metre;
};

/// Returns the unit in which gravity would be that of the Earth, else millimetres.
SmallLength small_length(const Case& setup) {
  constexpr SmallLength centimetres{"cm", 100}, millimetres{"mm", 1000};
  return is_of_the_earth(gravity_of(setup) / centimetres.in_a_metre) ? centimetres : millimetres;
}

}  // namespace

std::string viscosity_slip(const Case& setup) {
  constexpr const char* key = "fluid.kinematic_viscosity";
  if (!setup.units.si || !setup.places.count(key)) return "";
  const SmallLength small = small_length(setup);
  const double found = setup.units.physical(setup.fluid->kinematic_viscosity, dimension::viscosity);
  const double meant = found / (small.in_a_metre * small.in_a_metre);
  if (!(found > thickest && is_of_a_fluid(meant))) return "";
  const bool long_cells = !setup.places.count("units.relaxation_time") &&
                          (setup.fluid->relaxation_time - 0.5) * meant / found < least_excess;
  return fmt::format("if {} is in {}2/s, write {} (m2/s){}", key, small.name, shown(meant),
                     long_cells ? ", and lengths in m" : "");
}

std::string gravity_slip(const Case& setup) {
  const SmallLength small = small_length(setup);
  const double meant = gravity_of(setup) / small.in_a_metre;
  if (!setup.units.si || !is_of_the_earth(meant)) return "";
  return fmt::format("if gravity.acceleration is in {}/s2, write {} (m/s2)", small.name, shown(meant));
}

std::string motion_slip(const Case& setup) {
  const std::string viscosity = viscosity_slip(setup), gravity = gravity_slip(setup);
  return viscosity + (viscosity.empty() || gravity.empty() ? "" : ", and ") + gravity;
}

std::string length_slip(const Case& setup) {
  constexpr double millimetres = 1000, long_cell = 0.05;  // in a metre; m
  if (!setup.units.si || !setup.fluid) return "";
  const double excess = (setup.fluid->relaxation_time - 0.5) * millimetres * millimetres;
  if ((excess < least_excess || excess > most_excess) && setup.units.cell_size < long_cell) return "";
  return fmt::format("if lengths are in mm, write them in m (units.cell_size = {})",
                     shown(setup.units.cell_size / millimetres));
}

std::string size_slip(const Case& setup) {
  constexpr double millimetres = 1000;  // in a metre
  const rigid::Vec3 meant = setup.units.cell_size / millimetres * extent_of(setup).size;
  if (!setup.units.si || !(meant.minCoeff() > setup.units.cell_size)) return "";
  return fmt::format("if domain.size is in mm, write {} (m); else ", shown(meant));
}

std::string units_first(const Case& setup, const std::string& cure) {
  const std::string slip = motion_slip(setup), lengths = length_slip(setup);
  if (!slip.empty()) return slip;
  return lengths.empty() ? cure : lengths + "; else " + cure;
}

std::string scale_slip(const Case& setup, const std::string& entry, double across) {
  constexpr double far = 100;  // times the domain: in millimetres one of a tenth of its length is so large
  const double times = across / *std::ranges::max_element(setup.cells);
  if (times < far) return "";
  return fmt::format(
      "{}.file is {} across, {:.0f} times the domain: correct {}.scale, the unit of length of the file in "
      "that of the case{}",
      entry, shown_length(setup, across), times, entry, setup.units.si ? " (0.001 for millimetres)" : "");
}

std::string density_slip(const Case& setup, const std::string& key, double density) {
  const auto in = [](const char* unit, const std::string& keys, const std::string& numbers) {
    return fmt::format("if {} in {}, write {} (kg/m3)", keys, unit, numbers);
  };
  const double body_meant = cubic_centimetres * density,
               fluid_meant = cubic_centimetres * setup.units.density;
  const bool fluid = setup.fluid && is_of_a_solid(fluid_meant), solid = is_of_a_solid(density);
  if (!setup.units.si) return "";
  if (!solid && is_of_a_solid(body_meant) && fluid)
    return in("g/cm3", fmt::format("fluid.density and {} are", key),
              fmt::format("{} and {}", shown(fluid_meant), shown(body_meant)));
  if (!solid && is_of_a_solid(body_meant)) return in("g/cm3", key + " is", shown(body_meant));
  if (solid && fluid) return in("g/cm3", "fluid.density is", shown(fluid_meant));
  const double in_kilograms = density / 1000;
  return !solid && is_of_a_solid(in_kilograms) ? in("g/m3", key + " is", shown(in_kilograms)) : "";
}

}  // namespace silt

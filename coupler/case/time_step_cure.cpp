#include "coupler/case/time_step_cure.hpp"

#include <fmt/format.h>

#include <cmath>

#include "coupler/case/case.hpp"

namespace silt::coupler {
namespace {

constexpr double digit_rounding = 1e-9;  // of what two digits give already

/// One of the second digit of x.
double second_digit(double x) {
  return std::pow(10, std::floor(std::log10(x)) - 1);
}

}  // namespace

double rounded_down(double x) {
  return std::floor(x / second_digit(x) + digit_rounding) * second_digit(x);
}

double rounded_up(double x) {
  return std::ceil(x / second_digit(x) - digit_rounding) * second_digit(x);
}

std::string time_step_key(const Case& scene) {
  for (const char* key : {"units.relaxation_time", "units.max_velocity"})
    if (scene.places.count(key)) return key;
  return "units.time_step";
}

std::string time_step_cure(const Case& scene, double factor) {
  if (!scene.units.si) return "";
  const std::string key = time_step_key(scene);
  const double old = scene.units.time_step, excess = scene.fluid ? scene.fluid->relaxation_time - 0.5 : 0;
  if (key == "units.relaxation_time")
    return fmt::format("use {} = {}", key, shown(0.5 + rounded_down(factor * excess)));
  const double step = rounded_down(factor * old);
  constexpr double target = 0.05;  // cells a step: what units.max_velocity becomes
  const double value = key == "units.max_velocity" ? rounded_up(target * scene.units.cell_size / step) : step;
  const bool follows = scene.fluid && scene.places.count("fluid.kinematic_viscosity");
  return fmt::format("use {} = {}{}", key, shown(value),
                     follows ? fmt::format(" (relaxation time {:.3g})", 0.5 + excess * step / old) : "");
}

std::string shorter_step(const Case& scene) {
  if (!scene.units.si) return "";
  const std::string key = time_step_key(scene);
  return fmt::format("a {} {}", key == "units.max_velocity" ? "larger" : "smaller", key);
}

}  // namespace silt::coupler

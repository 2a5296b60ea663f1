#include "coupler/case/speed_check.hpp"

#include <fmt/format.h>

namespace silt::coupler {
namespace {

// Limits in lattice units: the error by compressibility grows with u^2.
constexpr double doubtful_velocity = 0.1, impossible_velocity = 0.3;

std::string in_case_units(const Units& units, double x, Dimension dimension, const char* si) {
  return units.si ? fmt::format(" ({} {})", shown(units.physical(x, dimension)), si) : std::string();
}

}  // namespace

void check_speed(const Units& units, Findings& findings, const std::string& key, double speed) {
  const std::string found = fmt::format("{} is {} cells a step{}", key, shown(speed),
                                        in_case_units(units, speed, dimension::velocity, "m/s"));
  const std::string remedy =
      units.si ? "shorten units.time_step (a smaller relaxation time with it) or the velocity" : "lower it";
  if (!(speed <= impossible_velocity))
    findings.error(key, fmt::format("{}; it must be at most {}: {}", found, impossible_velocity, remedy));
  else if (speed > doubtful_velocity)
    findings.warning(key, fmt::format("{}; above {} the fluid is noticeably compressible: {}", found,
                                      doubtful_velocity, remedy));
}

}  // namespace silt::coupler

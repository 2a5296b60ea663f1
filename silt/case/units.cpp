#include "silt/case/units.hpp"

#include <fmt/format.h>

#include <cstdlib>

namespace silt {
namespace {

/// SI units with names.
struct Named {
  Dimension dimension;
  const char* name;
};
constexpr Named named[] = {{dimension::force, "N"},
                           {dimension::torque, "N m"},
                           {dimension::energy, "J"},
                           {dimension::pressure, "Pa"},
                           {dimension::dynamic_viscosity, "Pa s"},
                           {dimension::velocity, "m/s"},
                           {{2, -3, 1}, "W"}};

}  // namespace

std::string Units::unit_text(Dimension d) const {
  if (si)
    for (const Named& unit : named)
      if (unit.dimension == d) return unit.name;
  struct Power {
    const char *many, *one;
    int exponent;
  };
  const Power powers[] = {{si ? "kg" : "cell masses", si ? "kg" : "cell mass", d.mass},
                          {si ? "m" : "cells", si ? "m" : "cell", d.length},
                          {si ? "s" : "steps", si ? "s" : "step", d.time}};
  std::string over, under;
  for (const auto& [many, one, exponent] : powers) {
    std::string& side = exponent > 0 ? over : under;
    if (exponent == 0) continue;
    side.append(side.empty() ? "" : " ").append(exponent > 0 ? many : one);
    if (std::abs(exponent) > 1) side += std::to_string(std::abs(exponent));
  }
  if (under.empty()) return over;
  if (under.find(' ') != std::string::npos) under = fmt::format("({})", under);
  return fmt::format("{}/{}", over.empty() ? "1" : over, under);
}

}  // namespace silt

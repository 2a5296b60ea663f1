#pragma once
// A pipe for tests.
#include <fmt/format.h>

#include <cmath>

#include "tests/silt/case/case_text.hpp"

namespace silt::testing {

/// A pipe along x, off the lattice, of 4 cells a period; nu = 0.1.
inline CaseText pipe(double radius, const std::string& wall, double force, int steps) {
  const int n = 2 * int(std::ceil(radius)) + 2;
  const auto text = [](double x) { return fmt::format("{:.17g}", x); };
  CaseText c;
  c.domain =
      domain_of({4, n, n}, R"({ x = "periodic", y = ["no-slip", "no-slip"], z = ["no-slip", "no-slip"] })");
  c.fluid =
      "[fluid]\nrelaxation_time = 0.8\nprecision = \"double\"\nbody_force = [" + text(force) + ", 0, 0]\n";
  c.rest = fmt::format(
      "[[walls]]\ntype = \"tube\"\nname = \"pipe\"\naxis = \"x\"\nradius = {}\npoint = [0, {}, {}]\n{}\n",
      text(radius), text(n / 2 + 0.13), text(n / 2 - 0.29), wall);
  c.shapes = c.bodies = "";
  c.run = fmt::format("[run]\nsteps = {}\n", steps);
  return c;
}

}  // namespace silt::testing

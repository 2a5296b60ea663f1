#pragma once
// Spheres that take one pass over their links, or two.

#include "silt/simulation.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::coupler::testing {

// Spheres of 12 cells, cli, relaxation time 1.2: the largest eigenvalue of M^-1 H is 4.87 / (12 rho). One
// pass takes those up to 1, by a bound for it, and under `exact` up to 0.167; the explicit step is stable up
// to twice that.
constexpr double heavy = 4, nearly_heavy = 2.3, light = 1.4;
constexpr double least_of_one_pass = 4.87 / 12;

/// `drive`: further lines of [fluid].
inline Simulation two_spheres(double first, double second, const Overrides& coupling, MPI_Comm comm,
                              const std::string& drive = "") {
  const auto sphere = [](double density, const std::string& position) {
    return body_of("sphere", density, "position = " + position + "\nangular_velocity = [0.002, 0, 0.001]");
  };
  CaseText c;
  c.domain = domain_of({20, 22, 44});
  c.fluid = "[fluid]\nrelaxation_time = 1.2\n" + drive;
  c.rest = "[gravity]\nacceleration = [0, 0, -3e-5]\n[coupling]\nwall_scheme = \"cli\"\n";
  c.shapes = sphere_of("sphere", 12);
  c.bodies = sphere(first, "[10.3, 11.1, 9.2]") + sphere(second, "[9.4, 10.2, 32.7]");
  return c.start(comm, coupling);
}

inline const std::string whole = "domain.blocks=\"auto\"", pieces = "domain.blocks=[10, 11, 11]";
inline const std::string implicit = "coupling.time=implicit", explicit_ = "coupling.time=explicit",
                         exact = "coupling.force=exact";

}  // namespace silt::coupler::testing

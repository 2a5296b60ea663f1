#pragma once
// Scenes of one quantity "q".

#include "tests/silt/case/case_text.hpp"

namespace silt::testing {

constexpr const char* finely_cut = "domain.blocks=[8, 16, 8]";  // 32 blocks

/// A dry scene of one quantity "q", periodic all round; balls of radius 4 and density 2.
inline CaseText dry_scene(const std::string& bodies, const std::string& quantity, int steps = 100) {
  CaseText c;
  c.domain = domain_of({32, 32, 32});
  c.fluid.clear();
  c.bodies.clear();
  if (!bodies.empty()) c.bodies = body_of("ball", 2, "") + bodies + "\n";
  c.run = "[run]\nsteps = " + std::to_string(steps) + "\n[[quantities]]\nname = \"q\"\n" + quantity + "\n";
  return c;
}

inline std::vector<double> numbers(const std::vector<std::pair<std::string, double>>& named) {
  std::vector<double> values;
  for (const auto& [name, value] : named) values.push_back(value);
  return values;
}

/// A scene of fluid alone with one quantity "q".
inline CaseText wet_scene(const std::string& domain, const std::string& fluid, const std::string& quantity,
                          int steps) {
  CaseText c = dry_scene("", quantity, steps);
  c.domain = "[domain]\n" + domain + "\n";
  c.fluid = "[fluid]\nprecision = \"double\"\n" + fluid + "\n";
  c.shapes.clear();
  return c;
}

inline CaseText vortex(const std::string& quantity, int steps = 1) {
  return wet_scene("size = [32, 32, 32]\nboundary = \"periodic\"",
                   "relaxation_time = 0.8\ninitial = { type = \"taylor-green-3d\", velocity = [0.02, 0, 0] }",
                   quantity, steps);
}

}  // namespace silt::testing

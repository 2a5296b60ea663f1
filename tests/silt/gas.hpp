#pragma once
// Streams of spheres through each other, without friction, gravity or loss: contacts alone, and an energy
// that nothing may change.
#include "tests/silt/case/case_text.hpp"

namespace silt::testing {

/// A hundred of them in a periodic box; lattice units. `contacts` are further lines of [contacts].
inline CaseText gas(const std::string& contacts = "") {
  CaseText c;
  c.domain = domain_of({20, 20, 20});
  c.fluid.clear();
  c.rest = "[contacts]\nrestitution = 1\nmargin = 0.2\n" + contacts;
  c.shapes = shape_of("ball", "sphere", "radius = 1");
  c.bodies.clear();
  for (const char* velocity : {"[0.01, 0, 0]", "[-0.01, 5e-3, 0]", "[0, -0.01, 5e-3]", "[3e-3, 0, -0.01]"})
    c.bodies += fill_of("ball", 1, 25, "gap = 0.1\nvelocity = " + std::string(velocity));
  return c;
}

}  // namespace silt::testing

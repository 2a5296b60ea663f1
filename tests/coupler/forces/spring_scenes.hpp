#pragma once
// Bodies on springs.
#include <fmt/format.h>

#include "tests/silt/case/case_text.hpp"

namespace silt::coupler::testing {

inline CaseText dry(const std::string& bodies, const std::string& springs) {
  CaseText c;
  c.fluid = "";
  c.domain = domain_of({64, 64, 64});
  c.bodies = bodies;
  c.rest = springs;
  return c;
}

/// Two balls apart from each other on any ranks: about their common centre, at the frequency of their reduced
/// mass, through a periodic side.
inline CaseText two_balls(double k) {
  return dry(body_of("ball", 1.2, "name = \"a\"\nposition = [60, 30, 32]") +
                 body_of("ball", 2.4, "name = \"b\"\nposition = [10, 34, 32]"),
             fmt::format("[[springs]]\nbody = \"a\"\nto = \"b\"\nlength = 12\nstiffness = {}\n", k));
}

}  // namespace silt::coupler::testing

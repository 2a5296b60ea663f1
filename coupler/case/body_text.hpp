#pragma once
// How messages about bodies name their keys, places and lengths.
#include <string>

#include "rigid/math/types.hpp"

namespace silt::coupler {

struct Case;

std::string entry_key(int entry);                          // "bodies[2]"
std::string position_key(const Case&, int entry);          // "bodies[2].position", or ".positions"
std::string shown_point(const Case&, const rigid::Vec3&);  // in the units of the case
std::string shown_length(const Case&, double);             // in the units of the case

}  // namespace silt::coupler

#pragma once
// How messages about bodies name their keys, places and lengths.
#include <string>

#include "rigid/math/types.hpp"

namespace silt::coupler {

struct BodySpec;
struct Case;

std::string body_name(const Case&, rigid::BodyId);  // "body 7"; "the wall 'bed'"; "the side z-low"
std::string entry_key(int entry);                   // "bodies[2]"
std::string position_key(const Case&, int entry);   // "bodies[2].position", or ".positions"
/// "bodies[2].position"; of a body from a file "bodies[2].positions, point 17 of cloud.csv".
std::string position_text(const Case&, const BodySpec&);
std::string shown_point(const Case&, const rigid::Vec3&);  // in the units of the case
std::string shown_length(const Case&, double);             // in the units of the case

}  // namespace silt::coupler

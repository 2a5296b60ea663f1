#pragma once
// Whether bodies from a checkpoint can be those of its case: a file may have every checksum right and still
// not be one that a run wrote.
#include <span>
#include <string>

#include "rigid/bodies/body_set.hpp"

namespace silt::coupler {

struct Case;

/// Returns what is wrong with the first body that no run can have left, or "".
std::string fault_of_bodies(const Case&, std::span<const rigid::BodyRecord>);

}  // namespace silt::coupler

#pragma once
// `--set key.path=value`: changes to the tree of a case file before it is read.
#include <string>

#include "coupler/case/case_error.hpp"

namespace silt::coupler {

/// Sets one value in the tree, making tables on the way. A key that says the same thing in another way
/// (run.steps and run.time) is removed. Throws CaseError.
void apply_override(adapters::Node& root, const std::string& argument);

}  // namespace silt::coupler

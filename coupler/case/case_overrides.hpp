#pragma once
// `--set key.path=value` and `--unset key.path`: changes to the tree of a case file before it is read.
#include <string>

#include "coupler/case/case_error.hpp"

namespace silt::coupler {

/// Sets one value in the tree, making tables on the way; a key that says the same thing in another way
/// (run.steps and run.time) is removed. "key.path=", without a value, takes the key, table or entry of a list
/// away; it must be there. Throws CaseError.
void apply_override(adapters::Node& root, const std::string& argument);

/// Returns the option that gives an override: "--set fluid.density=960", "--unset run.balance".
std::string override_text(const std::string& argument);

}  // namespace silt::coupler

#pragma once
// `--set key.path=value` and `--unset key.path`: changes to the tree of a case file before it is read.
#include <string>

#include "coupler/case/case_error.hpp"

namespace silt::coupler {

/// Sets one value in the tree, making tables on the way; a key that says the same thing in another way
/// (run.steps and run.time) is removed. "key.path=", without a value, takes the key, table or entry of a list
/// away; it must be there. Throws CaseError.
void apply_override(adapters::Node& root, const std::string& argument);

/// Return what is wrong with an argument of --set or --unset at first sight, or "". An empty value is more
/// often a variable of the shell that is not set than a key to be taken away.
std::string complaint_of_set(const std::string& argument);
std::string complaint_of_unset(const std::string& argument);

/// Returns the option that gives an override: "--set fluid.density=960", "--unset run.balance".
std::string override_text(const std::string& argument);

}  // namespace silt::coupler

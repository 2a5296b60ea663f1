#pragma once
// The environment variables that choose among builds of kernels and ways of computing: what they may say.
#include <string>

namespace silt {

/// Returns what is wrong with them, "" if nothing: a name that nobody knows would have no effect.
std::string complaint_of_environment();

}  // namespace silt

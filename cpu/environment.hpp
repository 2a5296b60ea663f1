#pragma once
// Checks the environment variables that select builds of kernels and prefetching.
#include <string>

namespace silt {

/// Returns a message for an invalid value, which would otherwise have no effect; "" if all are valid.
std::string environment_error();

}  // namespace silt

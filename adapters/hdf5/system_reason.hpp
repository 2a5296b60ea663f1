#pragma once
// Why the system refused something, for messages.
#include <string>

namespace silt::adapters {

/// Adds to the system's words for a file that is too large which limit that is.
std::string with_limit(std::string reason);

/// Returns the system's words for an error number.
std::string system_reason(int error);

}  // namespace silt::adapters

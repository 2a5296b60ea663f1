#include "adapters/hdf5/system_reason.hpp"

#include <cerrno>
#include <cstring>

namespace silt::adapters {

std::string with_limit(std::string reason) {
  if (reason == std::strerror(EFBIG)) reason += " (a limit on the size of files: see ulimit -f)";
  return reason;
}

std::string system_reason(int error) {
  return with_limit(std::strerror(error));
}

}  // namespace silt::adapters

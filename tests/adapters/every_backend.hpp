#pragma once
// The names of all collision backends, for tests that run on each.
#include <string>
#include <vector>

#include "adapters/automatic/collision_factory.hpp"

namespace silt::tests {

inline std::vector<std::string> every_backend() {
  const auto names = adapters::backend_names();
  return {names.begin(), names.end()};
}

}  // namespace silt::tests

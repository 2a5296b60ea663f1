#pragma once
// Things a test program does on request for a script that watches it from outside (writes until it is killed,
// say):
//   PROGRAM --act NAME
// They are no tests: nothing runs unless it is asked for by name.
#include <functional>
#include <map>
#include <string>

namespace silt::tests {

inline std::map<std::string, std::function<void()>>& acts() {
  static std::map<std::string, std::function<void()>> all;
  return all;
}

struct Act {
  Act(const char* name, std::function<void()> work) { acts()[name] = std::move(work); }
};

}  // namespace silt::tests

#pragma once
// Scenes that lack something, each with a driver beside it that calls only the passes the scene needs: what
// scripts/bench skip compares.
#include <functional>
#include <string>
#include <vector>

namespace silt::bench {

using Steps = std::function<void(int)>;  // goes on by so many

struct Row {
  std::string key, without;
  Steps scene, driver;
  bool timed = true;  // false: the scene begins anew in every call
};
std::vector<Row> skip_rows();

}  // namespace silt::bench

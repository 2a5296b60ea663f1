#pragma once
// What a benchmark leaves: lines for people as it goes, and at the end figures by key for programs.
//   {"machine": ..., "commit": ..., "figures": {KEY: number}, "table": [{...}, ...]}
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "adapters/json/json.hpp"

namespace silt::bench {

inline double seconds(auto&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The upper one of an even number.
inline double median(std::vector<double> x) {
  std::nth_element(x.begin(), x.begin() + x.size() / 2, x.end());
  return x[x.size() / 2];
}

inline std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

/// Keys are stable, lower case, dotted; rows of the table say by themselves what they are.
struct Figures {
  adapters::Json figures = adapters::Json::object(), table = adapters::Json::array();

  /// The commit is what scripts/bench found (SILT_COMMIT). std::runtime_error if the file cannot be written.
  void write(const std::string& file) const {
    const char* commit = std::getenv("SILT_COMMIT");
    const adapters::Json all = adapters::Json::object({{"machine", processor()},
                                                       {"commit", commit ? commit : "unknown"},
                                                       {"figures", figures},
                                                       {"table", table}});
    std::ofstream out(file);
    out << all.text() << '\n';
    if (!out.flush()) throw std::runtime_error("cannot write " + file);
  }
};

}  // namespace silt::bench

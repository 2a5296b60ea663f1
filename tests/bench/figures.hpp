#pragma once
// What a benchmark leaves: lines for people as it goes, and at the end figures by key for programs.
//   {"machine": ..., "commit": ..., "figures": {KEY: number}, "table": [{...}, ...]}
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace silt::bench {

using Json = nlohmann::ordered_json;

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

/// The options that every benchmark takes; the others are its own.
struct Options {
  bool quick = false;
  std::string json;  // file to write; empty: none
  std::vector<std::string> others;
};

inline Options options_of(int argc, char** argv) {
  Options o;
  for (int i = 1; i < argc; ++i) {
    const std::string a = argv[i];
    if (a == "--quick") {
      o.quick = true;
    } else if (a == "--json") {
      if (++i == argc) throw std::invalid_argument("--json needs the name of a file");
      o.json = argv[i];
    } else {
      o.others.push_back(a);
    }
  }
  return o;
}

/// std::invalid_argument naming an option that no one took.
inline void require_no_others(const Options& o) {
  if (!o.others.empty())
    throw std::invalid_argument("unknown option " + o.others[0] + "; known: --quick, --json FILE");
}

/// Keys are stable, lower case, dotted; rows of the table say by themselves what they are.
struct Figures {
  Json figures = Json::object(), table = Json::array();

  /// Nothing without a file. The commit is what scripts/bench found (SILT_COMMIT). std::runtime_error if the
  /// file cannot be written.
  void write(const std::string& file) const {
    if (file.empty()) return;
    const char* commit = std::getenv("SILT_COMMIT");
    const Json all = Json::object({{"machine", processor()},
                                   {"commit", commit ? commit : "unknown"},
                                   {"figures", figures},
                                   {"table", table}});
    std::ofstream out(file);
    out << all.dump(2) << '\n';
    if (!out.flush()) throw std::runtime_error("cannot write " + file);
  }
};

/// Samples of one figure, taken in turn with those of others.
struct Spread {
  std::vector<double> samples;
  void add(double x) { samples.push_back(x); }
  double middle() const { return median(samples); }
  double lowest() const { return *std::min_element(samples.begin(), samples.end()); }
  double highest() const { return *std::max_element(samples.begin(), samples.end()); }
};

/// Returns the ratios of samples, one by one.
inline Spread ratio(const Spread& a, const Spread& b) {
  Spread r;
  for (std::size_t k = 0; k < std::min(a.samples.size(), b.samples.size()); ++k)
    r.add(a.samples[k] / b.samples[k]);
  return r;
}

}  // namespace silt::bench

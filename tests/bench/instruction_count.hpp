#pragma once
// Instructions of pieces of a program, counted by valgrind's callgrind: the same on every run, and blind to
// caches (of which it is told that they are near). A program marks its pieces with count_piece and runs
// itself again below callgrind by count_instructions. valgrind knows no 512-bit vectors: what it counts is
// the 256-bit build of the kernels (cpu/isa.hpp sees to that).
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>

#if __has_include(<valgrind/callgrind.h>)
#include <valgrind/callgrind.h>
#else  // built without valgrind: nothing is ever counted
#define CALLGRIND_START_INSTRUMENTATION
#define CALLGRIND_STOP_INSTRUMENTATION
#define CALLGRIND_ZERO_STATS
#define CALLGRIND_DUMP_STATS_AT(name) static_cast<void>(name)
#endif

namespace silt::bench {

void count_piece(const std::string& name, auto&& work) {
  CALLGRIND_START_INSTRUMENTATION;
  CALLGRIND_ZERO_STATS;
  work();
  CALLGRIND_DUMP_STATS_AT(name.c_str());
  CALLGRIND_STOP_INSTRUMENTATION;
}

/// Name and instructions of each piece in callgrind's files of one run.
inline std::map<std::string, double> read_counts(const std::filesystem::path& folder) {
  const std::string reason = "desc: Trigger: Client Request: ", total = "totals: ";
  std::map<std::string, double> counts;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    std::ifstream in(file.path());
    std::string name;
    for (std::string line; std::getline(in, line);) {
      if (line.rfind(reason, 0) == 0) name = line.substr(reason.size());
      if (line.rfind(total, 0) == 0 && !name.empty()) counts[name] = std::stod(line.substr(total.size()));
    }
  }
  return counts;
}

/// Returns the instructions of the pieces that this program runs when it is given `arguments`.
/// std::runtime_error without valgrind.
inline std::map<std::string, double> count_instructions(const std::string& arguments) {
  namespace fs = std::filesystem;
  if (std::system("command -v valgrind >/dev/null") != 0)
    throw std::runtime_error(
        "instructions are counted by valgrind, which is not installed; run scripts/setup");
  std::string pattern = (fs::temp_directory_path() / "silt-count-XXXXXX").string();
  if (!mkdtemp(pattern.data())) throw std::runtime_error("cannot make a folder like " + pattern);
  const fs::path folder = pattern;
  const std::string command =
      "SILT_LAST_CACHE=near valgrind -q --tool=callgrind --instr-atstart=no --callgrind-out-file=" +
      (folder / "counts").string() + " " + fs::read_symlink("/proc/self/exe").string() + " " + arguments +
      " >/dev/null";
  const int code = std::system(command.c_str());
  const auto counts = read_counts(folder);
  fs::remove_all(folder);
  if (code != 0) throw std::runtime_error("below valgrind the program failed: " + command);
  return counts;
}

}  // namespace silt::bench

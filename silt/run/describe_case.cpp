// The text of `silt info` about a case and a folder of results.
#include <fmt/format.h>

#include <fstream>
#include <map>
#include <stdexcept>

#include "silt/case/case.hpp"
#include "silt/case/case_check.hpp"
#include "silt/case/case_file.hpp"
#include "silt/results/result_folder.hpp"
#include "silt/run/run.hpp"

namespace silt {

namespace fs = std::filesystem;

namespace {

std::string line(const std::string& name, const std::string& text) {
  return fmt::format("  {:<24}  {}\n", name, text);
}

/// Returns "checkpoint_*.h5" for checkpoint_000000000100.h5.
std::string family_of(const std::string& name) {
  const auto dot = name.find_last_of('.'), last = name.find_last_not_of("0123456789", dot - 1);
  const bool numbered = dot != name.npos && last != name.npos && last + 1 < dot && name[last] == '_';
  return numbered ? name.substr(0, last + 1) + "*" + name.substr(dot) : name;
}

/// Returns the last line of the log.
std::string end_of(const fs::path& log) {
  std::ifstream file(log);
  std::string last;
  for (std::string line; std::getline(file, line);)
    if (!line.empty()) last = line;
  return last;
}

std::string size_text(double bytes) {
  return bytes < 1e6 ? fmt::format("{:.1f} kB", bytes / 1e3) : fmt::format("{:.1f} MB", bytes / 1e6);
}

struct Family {
  int files = 0;
  double bytes = 0;
  std::string last;
};

std::string list_of_results(const fs::path& folder) {
  std::map<std::string, Family> families;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (!is_result(entry.path())) continue;
    const std::string name = entry.path().filename().string();
    Family& family = families[family_of(name)];
    ++family.files;
    family.bytes += double(entry.file_size(ignored));
    family.last = std::max(family.last, name);
  }
  if (families.empty()) return "";
  std::string text = fmt::format("results in {}\n", folder.string());
  for (const auto& [name, family] : families) {
    const std::string size = size_text(family.bytes);
    text += family.files == 1
                ? line(family.last, size)
                : line(name, fmt::format("{} files, {}, the last {}", family.files, size, family.last));
  }
  const std::string end = end_of(folder / "run.log");
  return end.empty() ? text : text + line("run.log ends with", end);
}

}  // namespace

std::string describe_case(const fs::path& path) {
  RunOptions options;
  options.directory = path;
  const bool is_case = path.extension() == ".toml" || fs::exists(path / "case.toml");
  const std::string results = list_of_results(is_case ? result_folder(options) : path);
  if (is_case) return derived_table(read_case(path)) + (results.empty() ? "no results\n" : results);
  if (results.empty())
    throw std::runtime_error(
        fmt::format("{}: is neither a case (a folder with a case.toml) nor a folder of results; what is in "
                    "a file of results `python3 -m silt_results FILE` says, in scripts/",
                    path.string()));
  return results;
}

}  // namespace silt

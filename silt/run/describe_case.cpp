// What is said of a case: `silt info` about it and a folder of results; the table and the warnings of an
// estimate.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <stdexcept>
#include <thread>

#include "silt/case/case.hpp"
#include "silt/case/case_check.hpp"
#include "silt/case/case_file.hpp"
#include "silt/results/result_folder.hpp"
#include "silt/run/run.hpp"
#include "silt/run/run_estimate.hpp"

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

namespace {

std::string bytes_text(double bytes) {
  if (bytes >= 1e12) return fmt::format("{:.2g} TB", bytes / 1e12);
  return bytes >= 1e9 ? fmt::format("{:.2g} GB", bytes / 1e9)
                      : fmt::format("{:.0f} MB", std::ceil(bytes / 1e6));
}

std::string seconds_text(double seconds) {
  constexpr double minute = 60, hour = 3600, day = 86400, year = 365 * day;
  if (seconds >= year) return fmt::format("{:.2g} years", seconds / year);
  if (seconds >= 2 * day) return fmt::format("{:.2g} days", seconds / day);
  if (seconds >= 2 * hour) return fmt::format("{:.2g} hours", seconds / hour);
  return seconds >= 2 * minute ? fmt::format("{:.0f} minutes", seconds / minute)
                               : fmt::format("{:.2g} s", seconds);
}

}  // namespace

std::string estimate_table(const Case& setup, const RunEstimate& e) {
  const int cores = std::max(1, int(std::thread::hardware_concurrency()));
  std::string text = fmt::format(
      "estimate (to a factor of 2 or so, on {} rank{} of this machine, on idle cores{})\n", e.ranks,
      e.ranks > 1 ? "s" : "", e.ranks > cores ? fmt::format(", of which it has {}", cores) : "");
  const auto add = [&](const std::string& name, const std::string& value) { text += line(name, value); };
  double cells = 0;
  for (std::size_t level = 0; level < e.cells.size(); ++level) {
    const double width = double(1 << level), volume = e.cells[level] * width * width * width;
    add(fmt::format("cells of level {}", level),
        fmt::format("{:.0f}, {:.2g} % of the domain", e.cells[level], 100 * volume / setup.volume()));
    cells += e.cells[level];
  }
  if (!e.cells.empty()) {
    add("  memory for them", fmt::format("{:.2g} of that if every cell were finest", cells / setup.volume()));
    add("  work of a step", fmt::format("{:.2g} of that if every cell were finest, borders included",
                                        e.cell_updates / setup.volume()));
  }
  add("time", fmt::format("{}, {:.2g} s a step", seconds_text(e.seconds), e.seconds_a_step));
  add("  of it for output",
      fmt::format("{} ({:.0f} %)", seconds_text(e.seconds_of_output), 100 * e.seconds_of_output / e.seconds));
  add("memory", bytes_text(e.memory));
  add("disk", bytes_text(e.disk));
  if (e.ranks > 1) add("work, largest over mean", fmt::format("{:.2f}", e.largest_over_mean));
  return text;
}

std::optional<Diagnostic> disk_warning(const Case& setup, double needed,
                                       const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::path there = std::filesystem::absolute(folder, error);
  while (!std::filesystem::exists(there, error) && there.has_relative_path()) there = there.parent_path();
  const auto space = std::filesystem::space(there, error);
  if (error || needed <= double(space.available)) return {};
  return Diagnostic{Diagnostic::Severity::warning, setup.place("output"),
                    fmt::format("the files of the run take about {}, and {} has {} left: write less often, "
                                "fewer fields or slices of them, or keep fewer checkpoints ({} times as much "
                                "fits)",
                                bytes_text(needed), there.string(), bytes_text(double(space.available)),
                                shown(std::floor(100 * double(space.available) / needed) / 100))};
}

std::optional<Diagnostic> time_warning(const Case& setup, const RunEstimate& estimate) {
  constexpr double year = 365. * 86400;
  if (estimate.seconds < year) return {};
  const char* key = setup.places.count("run.time") ? "run.time" : "run.steps";
  return Diagnostic{
      Diagnostic::Severity::warning, setup.place(key),
      fmt::format("{} is {} steps, which take about {} on {} rank{} of this machine: shorten it, "
                  "or use larger cells or a longer time step",
                  key, setup.steps, seconds_text(estimate.seconds), estimate.ranks,
                  estimate.ranks > 1 ? "s" : "")};
}

}  // namespace silt

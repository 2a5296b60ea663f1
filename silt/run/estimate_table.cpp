// What an estimate says: its table and its warnings.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "silt/case/case.hpp"
#include "silt/run/run_estimate.hpp"

namespace silt {
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
  const auto line = [&](const char* name, const std::string& value) {
    text += fmt::format("  {:<24}  {}\n", name, value);
  };
  double cells = 0;
  for (std::size_t level = 0; level < e.cells.size(); ++level) {
    const double width = double(1 << level), volume = e.cells[level] * width * width * width;
    line(fmt::format("cells of level {}", level).c_str(),
         fmt::format("{:.0f}, {:.2g} % of the domain", e.cells[level], 100 * volume / setup.volume()));
    cells += e.cells[level];
  }
  if (!e.cells.empty()) {
    line("  memory for them",
         fmt::format("{:.2g} of that if every cell were finest", cells / setup.volume()));
    line("  work of a step", fmt::format("{:.2g} of that if every cell were finest, borders included",
                                         e.cell_updates / setup.volume()));
  }
  line("time", fmt::format("{}, {:.2g} s a step", seconds_text(e.seconds), e.seconds_a_step));
  line("  of it for output", fmt::format("{} ({:.0f} %)", seconds_text(e.seconds_of_output),
                                         100 * e.seconds_of_output / e.seconds));
  line("memory", bytes_text(e.memory));
  line("disk", bytes_text(e.disk));
  if (e.ranks > 1) line("work, largest over mean", fmt::format("{:.2f}", e.largest_over_mean));
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

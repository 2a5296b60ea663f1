#include "coupler/results/run_series.hpp"

#include <array>
#include <cerrno>
#include <fstream>
#include <string_view>

#include "adapters/hdf5/system_reason.hpp"
#include "coupler/results/result_folder.hpp"

namespace silt::coupler {

namespace fs = std::filesystem;

namespace {

/// What of a report changes while a run goes on; of objects all numbers in them.
constexpr std::array series_columns = {"steps",        "time",           "wall_seconds", "mlups",
                                       "bodies",       "bodies_arrived", "bodies_left",  "bodies_left_by",
                                       "energy",       "momentum",       "max_velocity", "min_density",
                                       "max_density",  "mass_drift",     "mass_surplus", "bodies_asleep",
                                       "contacts_now", "momentum_drift", "links",        "max_penetration",
                                       "quantities",   "stage_seconds"};

using Numbers = std::vector<std::pair<std::string, std::string>>;

/// The numbers of a member of the report. Of a quantity that is a mean over steps that of the last step, and
/// then the mean under a name that says so.
Numbers values_now(const adapters::Json& report, const std::string& member) {
  Numbers numbers = report.numbers(member), means;
  if (member != "quantities") return numbers;
  const std::string in_last_step = "quantities_in_last_step.", mean = "means.";
  for (const auto& [path, now] : report.numbers("quantities_in_last_step")) {
    const std::string name = path.substr(in_last_step.size());
    for (auto& [other, number] : numbers)
      if (other == "quantities." + name) means.emplace_back(mean + name, std::exchange(number, now));
  }
  numbers.insert(numbers.end(), means.begin(), means.end());
  return numbers;
}

fs::path first_free_series(const fs::path& folder) {
  for (int n = 1;; ++n)
    if (const fs::path path = folder / ("series." + std::to_string(n) + ".csv"); !fs::exists(path))
      return path;
}

/// Moves a series away, so that another can begin in its place.
void set_aside(const fs::path& path) {
  const fs::path aside = first_free_series(path.parent_path());
  std::error_code error;
  fs::rename(path, aside, error);
  if (error)
    throw FileError(path.string() + ": cannot be moved to " + aside.filename().string() + ": " +
                    error.message());
}

}  // namespace

RunSeries::RunSeries(const fs::path& folder, std::int64_t resumed_at) : path_(folder / "series.csv") {
  if (resumed_at >= 0) there_ = remove_rows_after(path_, resumed_at);
}

void RunSeries::append(std::int64_t step, const adapters::Json& report) {
  if (step == there_.last_step) return;
  std::string names, row;
  for (const char* column : series_columns)
    for (const auto& [name, number] : values_now(report, column)) {
      const bool of_ranks = column == std::string_view("stage_seconds");  // of which the mean is enough
      if (of_ranks && !name.ends_with(".avg")) continue;
      (names += names.empty() ? "" : ",") += csv_field(name);
      (row += row.empty() ? "" : ",") += number;
    }
  const bool deleted = !fs::exists(path_), fresh = deleted || names != there_.columns;
  if (fresh && !deleted && !there_.columns.empty()) set_aside(path_);
  std::ofstream file(path_, fresh ? std::ios::trunc : std::ios::app);
  if (fresh) file << names << '\n';
  file << row << '\n';
  file.close();
  if (!file) throw FileError(path_.string() + ": cannot be written: " + adapters::system_reason(errno));
  there_ = {names, step};
}

}  // namespace silt::coupler

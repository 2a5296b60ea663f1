#include "silt/results/run_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>

#include <nlohmann/json.hpp>

#include "adapters/hdf5/disk.hpp"
#include "silt/case/case_error.hpp"
#include "silt/results/result_folder.hpp"

namespace silt {

namespace fs = std::filesystem;

namespace {

// ---- any table ----

/// Reads the column names, which may have line ends in quotes. Returns whether they are complete.
bool take_columns(std::istream& file, std::string& columns) {
  std::getline(file, columns);
  for (std::string more;
       std::count(columns.begin(), columns.end(), '"') % 2 != 0 && std::getline(file, more);)
    columns += '\n' + more;
  return !file.eof();
}

/// The columns of a file ("": missing or incomplete), and the step of its last row.
struct RowsLeft {
  std::string columns;
  std::int64_t last_step = -1;
};

/// Removes rows after a step, and an incomplete last row of a killed run.
RowsLeft remove_rows_after(const fs::path& path, std::int64_t step) {
  std::ifstream file(path);
  RowsLeft left;
  if (!file || !take_columns(file, left.columns)) return {};
  std::string kept = left.columns + '\n', row;
  while (std::getline(file, row) && !file.eof()) {  // a row without its end is incomplete
    std::int64_t found = 0;
    const auto [end, error] = std::from_chars(row.data(), row.data() + row.size(), found);
    if (error != std::errc() || *end != ',' || found > step) continue;
    kept += row + '\n';
    left.last_step = found;
  }
  file.close();
  write_text(path, kept);
  return left;
}

/// Adds rows to a file, or begins it anew with the column names.
void add_rows(const fs::path& path, bool fresh, const std::string& columns, const std::string& rows) {
  std::ofstream file(path, fresh ? std::ios::trunc : std::ios::app);
  if (fresh) file << columns << '\n';
  file << rows;
  file.close();
  if (!file) throw FileError(path.string() + ": cannot be written: " + adapters::system_reason(errno));
}

// ---- series.csv ----

/// The members of a report that change during a run; all numbers in an object are columns.
constexpr std::array series_columns = {
    "steps",           "time",           "wall_seconds", "mlups",        "bodies",         "bodies_arrived",
    "bodies_left",     "bodies_left_by", "energy",       "momentum",     "max_velocity",   "min_density",
    "max_density",     "mass_drift",     "mass_taken",   "contacts_now", "momentum_drift", "links",
    "max_penetration", "quantities",     "means",        "stage_seconds"};

using Json = nlohmann::ordered_json;

struct SeriesRow {
  std::string names, numbers;

  /// Adds a number, those in an object as "name.key", or a vector as "name.x". A null is an empty field.
  void add(const std::string& name, const Json& value) {
    if (!value.is_structured()) {
      (names += names.empty() ? "" : ",") += csv_field(name);
      (numbers += numbers.empty() ? "" : ",") += value.is_null() ? "" : value.dump();
    } else {
      for (const auto& [key, member] : value.items())
        add(name + '.' + (value.is_array() ? std::string(1, "xyz"[std::stoi(key)]) : key), member);
    }
  }
};

/// Returns whether the rows of the first step of a table are of these places.
bool has_places(const fs::path& path, const std::vector<std::string>& places) {
  std::ifstream file(path);
  std::string row, first_step;
  std::getline(file, row);  // column names
  std::size_t rows = 0;
  for (; std::getline(file, row); ++rows) {
    const std::size_t step = row.find(','), time = row.find(',', step + 1);
    if (rows == 0) first_step = row.substr(0, step);
    if (row.substr(0, step) != first_step) break;
    if (rows >= places.size() || row.compare(time + 1, places[rows].size() + 1, places[rows] + ',') != 0)
      return false;
  }
  return rows == places.size();
}

/// Renames a table, so that a new one can begin.
void set_aside(const fs::path& path) {
  fs::path aside;
  for (int n = 1; aside.empty() || fs::exists(aside); ++n)
    aside = path.parent_path() / fmt::format("{}.{}.csv", path.stem().string(), n);
  std::error_code error;
  fs::rename(path, aside, error);
  if (error)
    throw FileError(path.string() + ": cannot be moved to " + aside.filename().string() + ": " +
                    error.message());
}

}  // namespace

std::string csv_number(double x) {
  return std::isfinite(x) ? fmt::format("{}", x) : "";
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == text.npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + '"';
}

StepTable::StepTable(const fs::path& path, std::int64_t resumed_at, const std::vector<std::string>& places)
    : path_(path) {
  if (resumed_at < 0) return;
  const RowsLeft left = remove_rows_after(path_, resumed_at);
  columns_ = left.columns, last_step_ = left.last_step;
  is_of_other_places_ = left.last_step >= 0 && !places.empty() && !has_places(path_, places);
}

void StepTable::append(const std::string& columns, const TableRows& rows) {
  if (rows.text.empty() || rows.last_step == last_step_) return;
  const bool deleted = !fs::exists(path_), fresh = deleted || columns != columns_ || is_of_other_places_;
  if (fresh && !deleted && !columns_.empty()) set_aside(path_);
  add_rows(path_, fresh, columns, rows.text);
  columns_ = columns, last_step_ = rows.last_step, is_of_other_places_ = false;
}

/// A quantity that is a mean over steps has its value in the last step, and the mean under a name of its own.
/// Times of ranks are given as means.
void append_report(StepTable& series, std::int64_t step, const std::string& text) {
  Json report = Json::parse(text), means = Json::object();
  const Json in_last_step = report.value("quantities_in_last_step", Json::object());
  for (const auto& [name, now] : in_last_step.items())
    means[name] = std::exchange(report["quantities"][name], now);
  report["means"] = means;
  for (Json& seconds : report["stage_seconds"]) seconds = Json{{"avg", seconds["avg"]}};
  SeriesRow row;
  for (const char* column : series_columns)
    if (report.contains(column)) row.add(column, report[column]);
  series.append(row.names, {step, row.numbers + '\n'});
}

DepartureLog::DepartureLog(const fs::path& folder, std::int64_t resumed_at, const Units& units)
    : path_(folder / "departures.csv"), units_(units) {
  if (resumed_at >= 0) remove_rows_after(path_, resumed_at - 1);
}

void DepartureLog::append(std::span<const Departure> departures) {
  if (departures.empty()) return;
  const double cell = units_.cell_size;
  std::string rows;
  for (const Departure& d : departures)
    rows +=
        fmt::format("{},{},{},{},{},{},{}\n", d.step, double(d.step) * units_.time_step, d.id,
                    way_text(int(d.way)), d.position[0] * cell, d.position[1] * cell, d.position[2] * cell);
  add_rows(path_, !fs::exists(path_), "step,time,id,by,x,y,z", rows);
}

std::string departures_text(std::span<const Departure> departures) {
  constexpr std::size_t most_ids = 5;
  std::map<std::int64_t, std::vector<std::string>> ids;
  for (const Departure& d : departures) ids[d.way].push_back(std::to_string(d.id));
  std::string text =
      fmt::format("{} {} left: ", departures.size(), departures.size() > 1 ? "bodies have" : "body has");
  for (auto& [way, list] : ids) {
    const std::size_t count = list.size();
    list.resize(std::min(count, most_ids));
    if (way != ids.begin()->first) text += "; ";
    text += fmt::format("{}{} by {}", joined(list),
                        count > most_ids ? fmt::format(", ... ({} in all)", count) : "", way_text(int(way)));
  }
  return text;
}

}  // namespace silt

#pragma once
// The CSV files that a run adds rows to, each of which begins with the number of a step: series.csv, what
// report.json says of the moment, those of [[output.series]], and departures.csv, the bodies that left. A run
// that goes on keeps the rows up to its step. Errors are FileError, naming file and reason.
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "silt/body_turnover.hpp"
#include "silt/case/units.hpp"

namespace silt {

/// Rows of a table as text, and the step of the last.
struct TableRows {
  std::int64_t last_step = -1;
  std::string text = "";
};

class StepTable {
 public:
  /// Starts a table; with a step, goes on with the one there, without rows of later steps and an incomplete
  /// one. `places`: what the rows of a step have after step and time, if they are of places.
  explicit StepTable(const std::filesystem::path&, std::int64_t resumed_at = -1,
                     const std::vector<std::string>& places = {});
  /// Appends rows, unless the last one is of the same step. If their columns or their places are not those of
  /// the file (a quantity more, say), the file is renamed to series.1.csv (or .2, ...) and a new one begun.
  void append(const std::string& columns, const TableRows&);

 private:
  std::filesystem::path path_;
  std::string columns_;  // of the file; "": there is none
  bool is_of_other_places_ = false;
  std::int64_t last_step_ = -1;
};

/// Appends the row of a report, which is given as its text, to series.csv.
void append_report(StepTable&, std::int64_t step, const std::string& report);

/// A number of a row; an empty field for what has no value.
std::string csv_number(double);
/// A name as RFC 4180 has it: in quotes if there is a comma, a quote or a line end in it.
std::string csv_field(const std::string& text);

class DepartureLog {
 public:
  /// resumed_at: the step at which a run goes on, whose departures come again; -1 for a new run.
  DepartureLog(const std::filesystem::path& folder, std::int64_t resumed_at, const Units&);
  /// Adds lines; the file is there from the first one on.
  void append(std::span<const Departure>);

 private:
  std::filesystem::path path_;
  Units units_;
};

/// Returns "3 bodies have left: 12, 15 by z-high, 14 by outflow[0]", with the first few ids.
std::string departures_text(std::span<const Departure>);

}  // namespace silt

#pragma once
// The CSV files to which a run adds rows that begin with a step: series.csv with values of report.json, those
// of [[output.series]], and departures.csv with the bodies that left. A resumed run keeps the rows up to its
// step. Errors are FileError with file and reason.
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "silt/body_turnover.hpp"
#include "silt/case/units.hpp"

namespace silt {

/// Rows of a table as text, and the step of the last row.
struct TableRows {
  std::int64_t last_step = -1;
  std::string text = "";
};

class StepTable {
 public:
  /// Starts a table or, with a step, continues an existing one without later and incomplete rows. `places`:
  /// the fields after step and time of the rows of a step, for tables with several rows per step.
  explicit StepTable(const std::filesystem::path&, std::int64_t resumed_at = -1,
                     const std::vector<std::string>& places = {});
  /// Appends rows, unless the last row has the same step. If columns or places differ from those of the file,
  /// e.g. by a new quantity, renames the file to series.1.csv (or .2, ...) and begins a new one.
  void append(const std::string& columns, const TableRows&);

 private:
  std::filesystem::path path_;
  std::string columns_;  // of the file; "": none
  bool is_of_other_places_ = false;
  std::int64_t last_step_ = -1;
};

/// Appends the row of a report, given as text, to series.csv.
void append_report(StepTable&, std::int64_t step, const std::string& report);

/// Returns a number of a row; an empty field if there is no value.
std::string csv_number(double);
/// Returns a name as in RFC 4180: quoted if it has a comma, a quote or a line end.
std::string csv_field(const std::string& text);

class DepartureLog {
 public:
  /// resumed_at: the step at which a run resumes, whose departures are repeated; -1 for a new run.
  DepartureLog(const std::filesystem::path& folder, std::int64_t resumed_at, const Units&);
  /// Adds lines; the first call makes the file.
  void append(std::span<const Departure>);

 private:
  std::filesystem::path path_;
  Units units_;
};

/// Returns "3 bodies have left: 12, 15 by z-high, 14 by outflow[0]", with the first few ids.
std::string departures_text(std::span<const Departure>);

}  // namespace silt

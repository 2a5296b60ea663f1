#pragma once
// series.csv: what report.json says of the moment, a row each time it is written.
#include <cstdint>
#include <filesystem>
#include <string>

#include "adapters/json/json.hpp"
#include "coupler/results/csv_rows.hpp"

namespace silt::coupler {

class RunSeries {
 public:
  /// Starts the series in a folder; with a step, goes on with the one there: rows of later steps, and one
  /// that a killed run left incomplete, are removed.
  explicit RunSeries(const std::filesystem::path& folder, std::int64_t resumed_at = -1);
  /// Appends a report's row, unless the last one is of the same step. If its columns are not those of the
  /// file (a quantity more, say), the file is renamed to series.1.csv (or .2, ...) and a new one begun.
  /// FileError naming file and reason.
  void append(std::int64_t step, const adapters::Json& report);

 private:
  std::filesystem::path path_;
  CsvRows there_;
};

}  // namespace silt::coupler

#pragma once
// CSV files of runs, whose rows begin with the number of a step.
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace silt::coupler {

/// Returns a field as RFC 4180 has it: in quotes if there is a comma, a quote or a line end in it.
std::string csv_field(std::string_view);

/// What is left of such a file: the names of the columns as they stand, and the step of its last row.
struct CsvRows {
  std::string columns;  // "": there is no such file, or not all of their names
  std::int64_t last_step = -1;
};

/// Removes the rows of steps after the given one, and a last row that a killed run left without its end.
/// FileError.
CsvRows remove_rows_after(const std::filesystem::path&, std::int64_t step);

}  // namespace silt::coupler

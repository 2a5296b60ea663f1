#pragma once
// Rows of CSV files that begin with the number of a step, of runs that go on.
#include <cstdint>
#include <filesystem>
#include <string>

namespace silt::coupler {

/// Removes the rows of steps after the given one, and a last row that a killed run left without its end.
/// Returns the first line, which names the columns; "" if there is no such file. FileError.
std::string remove_rows_after(const std::filesystem::path&, std::int64_t step);

}  // namespace silt::coupler

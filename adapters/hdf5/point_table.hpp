#pragma once
// Points in an HDF5 file that another program wrote: a dataset of three numbers a row.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace silt::adapters {

/// Returns the number of points in a dataset [n][3] of any type of number. Local. std::runtime_error names
/// file and dataset and says what is wrong.
std::uint64_t count_points(const std::filesystem::path&, const std::string& dataset);

/// Reads the points [first, first + n), three numbers each. Local; ranks may read at once. Errors as above.
std::vector<double> read_points(const std::filesystem::path&, const std::string& dataset, std::uint64_t first,
                                std::uint64_t n);

}  // namespace silt::adapters

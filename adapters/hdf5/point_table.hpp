#pragma once
// Points in an HDF5 file from another program: a dataset of three numbers per row.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace silt::adapters {

/// Returns the number of points in a dataset [n][3] of any type. Local. Errors: std::runtime_error.
std::uint64_t count_points(const std::filesystem::path&, const std::string& dataset);

/// Reads the points [first, first + n), three numbers each. Local. Errors as above.
std::vector<double> read_points(const std::filesystem::path&, const std::string& dataset, std::uint64_t first,
                                std::uint64_t n);

}  // namespace silt::adapters

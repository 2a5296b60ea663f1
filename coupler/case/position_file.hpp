#pragma once
// Positions of bodies in a file beside the case, read in slices: a CSV file, a point a line, or a dataset of
// an HDF5 file.
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace silt::coupler {

/// Names positions as a case does: "cloud.csv", or "cloud.h5:/group/points", a dataset of a file.
struct PositionFile {
  std::string file, dataset;  // dataset: "" of CSV

  std::string name() const { return dataset.empty() ? file : file + ':' + dataset; }
};

/// Returns whose name it is; std::invalid_argument says what names there are.
PositionFile position_file(const std::string& name);

/// Some of the points of a file, one after the other, in the units of the case.
struct PositionSlice {
  std::vector<std::array<double, 3>> points;
  std::string fault;  // what is wrong with the next one, which ended the reading; "" if nothing
};

/// Reads part `part` of `parts` of a file: together they are all points in the order of the file. A CSV file
/// may begin with a line of headings; empty lines and lines from # on do not count. std::runtime_error names
/// a file that cannot be read.
PositionSlice read_slice(const std::filesystem::path& directory, const PositionFile&, int part, int parts);

/// Counts the points of a file, whether they are good or not. Errors as above.
std::uint64_t count_points(const std::filesystem::path& directory, const PositionFile&);

}  // namespace silt::coupler

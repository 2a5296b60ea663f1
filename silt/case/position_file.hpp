#pragma once
// A file with positions of bodies, read in slices: a CSV file with one body per line, or a dataset of an HDF5
// file. A CSV file may also give orientations and velocities.
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace silt {

/// A name of positions in a case: "cloud.csv", or "cloud.h5:/group/points" for a dataset.
struct PositionFile {
  std::string file, dataset;  // dataset: "" for CSV

  std::string name() const { return dataset.empty() ? file : file + ':' + dataset; }
};

/// Parses a name. Throws std::invalid_argument with the forms of names.
PositionFile position_file(const std::string& name);

/// A group of columns of a CSV file, named after the keys of [[bodies]].
struct ColumnGroup {
  std::string_view prefix, letters;
  int begin;

  constexpr int end() const { return begin + static_cast<int>(letters.size()); }
};
inline constexpr ColumnGroup column_groups[] = {
    {"", "xyz", 0}, {"orientation.", "wxyz", 3}, {"velocity.", "xyz", 7}, {"angular_velocity.", "xyz", 10}};
inline constexpr const ColumnGroup &orientation_columns = column_groups[1],
                                   &velocity_columns = column_groups[2], &turn_columns = column_groups[3];
inline constexpr int position_columns = turn_columns.end();

/// The numbers of a body by column; columns that a file lacks are unchanged.
using FiledPose = std::array<double, position_columns>;

/// The summary of a file that a case needs before bodies are read.
struct PositionContents {
  std::uint64_t points = 0;                                              // valid or not
  int headings = 0;                                                      // number of lines
  bool orientation = false, velocity = false, angular_velocity = false;  // whether the file has them
  FiledPose fastest = {};  // largest velocities, in units of the case
};

/// Summarises a file. Throws std::runtime_error (unreadable) or std::invalid_argument (headings).
PositionContents scan(const std::filesystem::path& directory, const PositionFile&);

/// Consecutive bodies of a file, in units of the case.
struct PositionSlice {
  std::vector<int> columns;     // meaning of the numbers of a body
  std::vector<double> numbers;  // columns.size() per body
  std::uint64_t lines = 0;      // of a CSV file, read so far
  std::string fault;            // of the next body, which ended reading; or ""

  std::uint64_t size() const { return columns.empty() ? 0 : numbers.size() / columns.size(); }
  /// Copies the numbers of a body to their columns.
  void put(std::size_t body, FiledPose&) const;
};

/// Reads part `part` of `parts` of a file, whose parts are in the order of the file. Throws like scan.
PositionSlice read_slice(const std::filesystem::path& directory, const PositionFile&, int part, int parts);

}  // namespace silt

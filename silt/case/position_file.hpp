#pragma once
// A file beside the case gives positions of bodies and is read in slices: a CSV file, a body a line, or a
// dataset of an HDF5 file. A CSV file may also say how bodies are turned and how they move.
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace silt {

/// Names positions as a case does: "cloud.csv", or "cloud.h5:/group/points", a dataset of a file.
struct PositionFile {
  std::string file, dataset;  // dataset: "" of CSV

  std::string name() const { return dataset.empty() ? file : file + ':' + dataset; }
};

/// Returns whose name it is; std::invalid_argument says what names there are.
PositionFile position_file(const std::string& name);

/// Columns of a CSV file that go together, named after the keys of [[bodies]].
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

/// The numbers of one body's line, by its columns; those that a file does not have stay as they were.
using FiledPose = std::array<double, position_columns>;

/// The contents of a file, as far as a case has to know them before the bodies are read.
struct PositionContents {
  std::uint64_t points = 0;                                              // good or not
  int headings = 0;                                                      // lines
  bool orientation = false, velocity = false, angular_velocity = false;  // whether it says them
  FiledPose fastest = {};  // the largest velocities that it says, in the units of the case
};

/// Looks through a file. std::runtime_error names one that cannot be read, std::invalid_argument says what is
/// wrong with its headings.
PositionContents scan(const std::filesystem::path& directory, const PositionFile&);

/// Some of the bodies of a file, one after the other, in the units of the case.
struct PositionSlice {
  std::vector<int> columns;     // of what a body's numbers are
  std::vector<double> numbers;  // columns.size() a body
  std::uint64_t lines = 0;      // read of a CSV file
  std::string fault;            // what is wrong with the next body, which ended the reading; "" if nothing

  std::uint64_t size() const { return columns.empty() ? 0 : numbers.size() / columns.size(); }
  /// Puts the numbers of a body where they belong.
  void put(std::size_t body, FiledPose&) const;
};

/// Reads part `part` of `parts` of a file: together they are all bodies in the order of the file. Errors as
/// above.
PositionSlice read_slice(const std::filesystem::path& directory, const PositionFile&, int part, int parts);

}  // namespace silt

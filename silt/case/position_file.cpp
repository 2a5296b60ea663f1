#include "silt/case/position_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "adapters/hdf5/point_table.hpp"
#include "silt/case/case_error.hpp"
#include "silt/case/csv_reader.hpp"

namespace silt {

namespace fs = std::filesystem;

namespace {

bool has(const std::vector<int>& columns, ColumnGroup group) {
  return std::ranges::any_of(columns, [&](int k) { return k >= group.begin && k < group.end(); });
}

/// Returns the name of a column, that of its key in [[bodies]].
std::string column_name(int column) {
  const ColumnGroup* group = std::begin(column_groups);
  while (column >= group->end()) ++group;
  return std::string(group->prefix) + group->letters[column - group->begin];
}

/// Returns the column of a heading, without its unit in brackets, or -1.
int column_of(std::string_view heading) {
  std::string name(trimmed(heading.substr(0, heading.find_first_of("[("))));
  for (char& c : name)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  for (int k = 0; k < position_columns; ++k)
    if (name == column_name(k)) return k;
  return -1;
}

[[noreturn]] void refuse_headings(const std::string& what) {
  throw std::invalid_argument(
      fmt::format("its headings {}; they must name x, y, z and may name all of orientation.w, .x, .y, .z, of "
                  "velocity.x, .y, .z and of angular_velocity.x, .y, .z",
                  what));
}

/// Three headings may have any names that do not contradict the order x, y, z.
bool may_be_positions(const std::vector<int>& columns) {
  for (int k = 0; k < static_cast<int>(columns.size()); ++k)
    if (columns[k] >= 0 && columns[k] != k) return false;
  return columns.size() == 3;
}

/// Returns the columns named by heading lines; x, y, z if there are none.
std::vector<int> columns_of(const std::vector<std::vector<std::string>>& headings) {
  std::vector<int> columns = {0, 1, 2};
  for (const auto& line : headings) {
    std::vector<int> named;
    for (const std::string& heading : line) named.push_back(column_of(heading));
    const auto unknown = std::ranges::find(named, -1);
    if (std::ranges::count(named, -1) == std::ssize(named)) continue;
    if (unknown == named.end())
      columns = named;
    else if (!may_be_positions(named))
      refuse_headings(fmt::format("name \"{}\"", line[unknown - named.begin()]));
  }
  for (const ColumnGroup& group : column_groups)
    for (int k = group.begin; k < group.end(); ++k) {
      const auto times = std::ranges::count(columns, k);
      if (times > 1) refuse_headings(fmt::format("name {} twice", column_name(k)));
      if (times == 0 && (group.begin == 0 || has(columns, group)))
        refuse_headings(fmt::format("do not name {}", column_name(k)));
    }
  return columns;
}

std::ifstream opened(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream || !fs::is_regular_file(path))
    throw std::runtime_error(path.string() + ": there is no such file, or it cannot be read");
  return stream;
}

std::string line_of(const std::vector<int>& columns) {
  std::vector<std::string> names;
  for (const int k : columns) names.push_back(column_name(k));
  return fmt::format("{} finite numbers with commas between them: {}", columns.size(), joined(names));
}

bool has_no_direction(const PositionSlice& slice, std::size_t body) {
  FiledPose pose = {};
  slice.put(body, pose);
  return std::all_of(&pose[orientation_columns.begin], &pose[orientation_columns.end()],
                     [](double q) { return q == 0; });
}

PositionSlice read_csv(const fs::path& path, int part, int parts) {
  std::ifstream stream = opened(path);
  CsvReader reader(stream);
  PositionSlice slice{columns_of(reader.headings()), {}, 0, ""};
  const std::size_t width = slice.columns.size();
  const std::string must = line_of(slice.columns);
  const bool turned = has(slice.columns, orientation_columns);
  reader.take_part(part, parts);
  while (slice.fault.empty() && reader.next()) {
    slice.numbers.resize(slice.numbers.size() + width);
    try {
      reader.numbers({slice.numbers.end() - static_cast<std::ptrdiff_t>(width), slice.numbers.end()}, must);
    } catch (const std::invalid_argument& error) {
      slice.fault = error.what();
    }
    if (slice.fault.empty() && turned && has_no_direction(slice, slice.size() - 1))
      slice.fault = "has an orientation of four zeros; it must be a quaternion w, x, y, z";
    if (!slice.fault.empty()) slice.numbers.resize(slice.numbers.size() - width);
  }
  slice.lines = reader.lines();
  return slice;
}

PositionSlice read_hdf5(const fs::path& path, const std::string& dataset, int part, int parts) {
  PositionSlice slice{{0, 1, 2}, {}, 0, ""};
  const std::uint64_t n = adapters::count_points(path, dataset), first = n * part / parts;
  slice.numbers = adapters::read_points(path, dataset, first, n * (part + 1) / parts - first);
  const auto bad = std::ranges::find_if(slice.numbers, [](double x) { return !std::isfinite(x); });
  if (bad == slice.numbers.end()) return slice;
  slice.fault = fmt::format("has the coordinate {}; it must be three finite numbers, x, y, z", *bad);
  slice.numbers.resize((bad - slice.numbers.begin()) / 3 * 3);
  return slice;
}

/// Keeps the longer of two vectors.
void keep_longer(const FiledPose& pose, const ColumnGroup& group, FiledPose& longest) {
  const auto square = [](const double* v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; };
  if (square(&pose[group.begin]) > square(&longest[group.begin]))
    std::copy_n(&pose[group.begin], 3, &longest[group.begin]);
}

PositionContents scan_csv(const fs::path& path) {
  std::ifstream stream = opened(path);
  CsvReader reader(stream);
  const std::vector<int> columns = columns_of(reader.headings());
  PositionContents found;
  found.headings = static_cast<int>(reader.headings().size());
  found.orientation = has(columns, orientation_columns);
  found.velocity = has(columns, velocity_columns), found.angular_velocity = has(columns, turn_columns);
  std::vector<double> numbers(columns.size());
  for (; reader.next(); ++found.points) try {
      if (!found.velocity && !found.angular_velocity) continue;
      reader.numbers(numbers, "");
      FiledPose pose = {};
      for (std::size_t k = 0; k < columns.size(); ++k) pose[columns[k]] = numbers[k];
      keep_longer(pose, velocity_columns, found.fastest);
      keep_longer(pose, turn_columns, found.fastest);
    } catch (const std::invalid_argument&) {  // reported by the rank that reads these bodies
    }
  return found;
}

}  // namespace

void PositionSlice::put(std::size_t body, FiledPose& pose) const {
  for (std::size_t k = 0; k < columns.size(); ++k) pose[columns[k]] = numbers[body * columns.size() + k];
}

PositionFile position_file(const std::string& name) {
  const auto colon = name.rfind(':');
  const PositionFile positions{name.substr(0, colon), colon == name.npos ? "" : name.substr(colon + 1)};
  const std::string kind = fs::path(positions.file).extension();
  if (kind == ".csv" && colon == name.npos) return positions;
  if ((kind == ".h5" || kind == ".hdf5") && !positions.dataset.empty()) return positions;
  throw std::invalid_argument(
      "it must be a CSV file, \"cloud.csv\", or an HDF5 file and a dataset in it, \"cloud.h5:/points\"");
}

PositionSlice read_slice(const fs::path& directory, const PositionFile& positions, int part, int parts) {
  const fs::path path = directory / positions.file;
  return positions.dataset.empty() ? read_csv(path, part, parts)
                                   : read_hdf5(path, positions.dataset, part, parts);
}

PositionContents scan(const fs::path& directory, const PositionFile& positions) {
  const fs::path path = directory / positions.file;
  if (positions.dataset.empty()) return scan_csv(path);
  PositionContents found;
  found.points = adapters::count_points(path, positions.dataset);
  return found;
}

}  // namespace silt

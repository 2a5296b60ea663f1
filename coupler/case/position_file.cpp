#include "coupler/case/position_file.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string_view>

#include "adapters/hdf5/point_table.hpp"
#include "coupler/case/trimmed.hpp"

namespace silt::coupler {

namespace fs = std::filesystem;

namespace {

bool begins_with_number(std::string_view text) {
  double x = 0;
  return std::from_chars(text.data(), text.data() + text.size(), x).ec == std::errc{};
}

/// Takes a number and what parts it from the next one; false if there is none.
bool take_number(std::string_view& text, double& x) {
  text = trimmed(text);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
  if (error != std::errc{} || !std::isfinite(x)) return false;
  text = trimmed(text.substr(static_cast<std::size_t>(end - text.data())));
  if (text.empty()) return true;
  if (text[0] != ',') return false;
  text.remove_prefix(1);
  return true;
}

bool take_point(std::string_view text, std::array<double, 3>& point) {
  if (!text.empty() && text.back() == ',') return false;
  for (double& x : point)
    if (!take_number(text, x)) return false;
  return text.empty();
}

/// Calls point(line) for the lines of points that begin in part `part` of `parts` of a file's bytes, until it
/// returns false.
template <class Point>
void for_lines(const fs::path& path, int part, int parts, Point&& point) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream || !fs::is_regular_file(path))
    throw std::runtime_error(path.string() + ": there is no such file, or it cannot be read");
  const std::uint64_t size = fs::file_size(path), end = size * (part + 1) / parts;
  std::uint64_t at = size * part / parts;
  std::string line;
  if (at > 0) {  // in the middle of a line of the part before, or just behind it
    stream.seekg(static_cast<std::streamoff>(--at));
    if (std::getline(stream, line)) at += line.size() + 1;
  }
  while (at < end && std::getline(stream, line)) {
    const bool first = at == 0;
    at += line.size() + 1;
    const std::string_view text = trimmed(line);
    if (text.empty() || text[0] == '#') continue;
    if (first && !begins_with_number(text)) continue;  // headings
    if (!point(text)) return;
  }
  if (stream.bad()) throw std::runtime_error(path.string() + ": cannot be read to its end");
}

PositionSlice read_csv(const fs::path& path, int part, int parts) {
  PositionSlice slice;
  for_lines(path, part, parts, [&](std::string_view line) {
    std::array<double, 3> x;
    if (take_point(line, x)) return slice.points.push_back(x), true;
    slice.fault = fmt::format("is \"{}\"", line.substr(0, 60));
    return false;
  });
  return slice;
}

PositionSlice read_hdf5(const fs::path& path, const std::string& dataset, int part, int parts) {
  PositionSlice slice;
  const std::uint64_t n = adapters::count_points(path, dataset), first = n * part / parts;
  slice.points = adapters::read_points(path, dataset, first, n * (part + 1) / parts - first);
  for (std::size_t i = 0; i < slice.points.size(); ++i)
    for (const double x : slice.points[i]) {
      if (std::isfinite(x)) continue;
      slice.fault = fmt::format("has the coordinate {}", x);
      slice.points.resize(i);
      return slice;
    }
  return slice;
}

}  // namespace

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

std::uint64_t count_points(const fs::path& directory, const PositionFile& positions) {
  const fs::path path = directory / positions.file;
  if (!positions.dataset.empty()) return adapters::count_points(path, positions.dataset);
  std::uint64_t n = 0;
  for_lines(path, 0, 1, [&](std::string_view) { return ++n > 0; });
  return n;
}

}  // namespace silt::coupler

#include "coupler/results/csv_rows.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>

#include "coupler/results/result_folder.hpp"

namespace silt::coupler {

namespace {

/// Reads the names of the columns; a name in quotes may go on over ends of lines. Returns whether they are
/// whole.
bool take_columns(std::istream& file, std::string& columns) {
  std::getline(file, columns);
  for (std::string more;
       std::count(columns.begin(), columns.end(), '"') % 2 != 0 && std::getline(file, more);)
    columns += '\n' + more;
  return !file.eof();
}

}  // namespace

std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == text.npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + '"';
}

CsvRows remove_rows_after(const std::filesystem::path& path, std::int64_t step) {
  std::ifstream file(path);
  CsvRows left;
  if (!file || !take_columns(file, left.columns)) return {};
  std::string kept = left.columns + '\n', row;
  while (std::getline(file, row) && !file.eof()) {  // without its end a row is not whole
    std::int64_t found = 0;
    const auto [end, error] = std::from_chars(row.data(), row.data() + row.size(), found);
    if (error != std::errc() || *end != ',' || found > step) continue;
    kept += row + '\n';
    left.last_step = found;
  }
  file.close();
  write_text(path, kept);
  return left;
}

}  // namespace silt::coupler

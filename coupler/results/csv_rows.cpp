#include "coupler/results/csv_rows.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <string_view>

#include "coupler/results/result_folder.hpp"

namespace silt::coupler {

namespace {

bool is_up_to(std::string_view row, std::int64_t step) {
  std::int64_t found = 0;
  const auto [end, error] = std::from_chars(row.data(), row.data() + row.size(), found);
  return error == std::errc() && *end == ',' && found <= step;
}

/// Reads the names of the columns; a name in quotes may go on over ends of lines.
bool take_columns(std::istream& file, std::string& columns) {
  if (!std::getline(file, columns)) return false;
  for (std::string more;
       std::count(columns.begin(), columns.end(), '"') % 2 != 0 && std::getline(file, more);)
    columns += '\n' + more;
  return true;
}

}  // namespace

std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == text.npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + '"';
}

std::string remove_rows_after(const std::filesystem::path& path, std::int64_t step) {
  std::ifstream file(path);
  std::string columns;
  if (!take_columns(file, columns)) return "";
  std::string kept = columns + '\n', row;
  while (std::getline(file, row) && !file.eof())  // without its end a row is not whole
    if (is_up_to(row, step)) kept += row + '\n';
  file.close();
  write_text(path, kept);
  return columns;
}

}  // namespace silt::coupler

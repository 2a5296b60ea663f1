#include "coupler/results/csv_rows.hpp"

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

}  // namespace

std::string remove_rows_after(const std::filesystem::path& path, std::int64_t step) {
  std::ifstream file(path);
  std::string columns;
  if (!std::getline(file, columns)) return "";
  std::string kept = columns + '\n', row;
  while (std::getline(file, row) && !file.eof())  // without its end a row is not whole
    if (is_up_to(row, step)) kept += row + '\n';
  file.close();
  write_text(path, kept);
  return columns;
}

}  // namespace silt::coupler

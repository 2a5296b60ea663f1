#include "coupler/case/motion_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "coupler/case/trimmed.hpp"

namespace silt::coupler {
namespace {

/// Numbers with commas between them; false for anything else.
bool take_numbers(std::string_view line, std::array<double, 7>& numbers) {
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const auto comma = line.find(',');
    if ((comma == line.npos) != (k + 1 == numbers.size())) return false;
    const std::string_view word = trimmed(line.substr(0, comma));
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), numbers[k]);
    if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(numbers[k])) return false;
    if (comma != line.npos) line.remove_prefix(comma + 1);
  }
  return true;
}

}  // namespace

std::vector<rigid::MotionRow> read_motion_file(std::string_view text, const Units& units) {
  std::vector<rigid::MotionRow> rows;
  int number = 0;
  while (!text.empty()) {
    ++number;
    const auto end = std::min(text.find('\n'), text.size());
    const std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.empty() || line[0] == '#') continue;
    std::array<double, 7> x;
    if (!take_numbers(line, x)) {
      if (number == 1) continue;  // headings
      throw std::invalid_argument(
          fmt::format("line {} is \"{}\"; it must have seven numbers with commas between them: time, "
                      "displacement x, y, z, "
                      "rotation vector x, y, z",
                      number, line.substr(0, 60)));
    }
    const double time = units.lattice(x[0], dimension::time), length = units.lattice(1, dimension::length);
    if (!rows.empty() && !(time > rows.back().time))
      throw std::invalid_argument(
          fmt::format("line {}: its time is not after that of the line before", number));
    rows.push_back({time, length * rigid::Vec3(x[1], x[2], x[3]), {x[4], x[5], x[6]}});
  }
  if (rows.size() < 2) throw std::invalid_argument("it must have two lines of numbers or more");
  return rows;
}

}  // namespace silt::coupler

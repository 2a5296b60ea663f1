#include "coupler/case/motion_file.hpp"

#include <fmt/format.h>

#include <array>
#include <sstream>
#include <stdexcept>

#include "coupler/case/csv_reader.hpp"

namespace silt::coupler {

MotionFile read_motion_file(const std::string& text, const Units& units) {
  std::istringstream stream(text);
  CsvReader reader(stream);
  MotionFile file{{}, static_cast<int>(reader.headings().size())};
  const double length = units.lattice(1, dimension::length);
  while (reader.next()) {
    std::array<double, 7> x;
    try {
      reader.numbers(
          x,
          "seven finite numbers with commas between them: time, displacement x, y, z, rotation vector "
          "x, y, z");
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(fmt::format("line {} {}", reader.lines(), error.what()));
    }
    const double time = units.lattice(x[0], dimension::time);
    if (!file.rows.empty() && !(time > file.rows.back().time))
      throw std::invalid_argument(
          fmt::format("line {}: its time is not after that of the line before", reader.lines()));
    file.rows.push_back({time, length * rigid::Vec3(x[1], x[2], x[3]), {x[4], x[5], x[6]}});
  }
  if (file.rows.size() < 2) throw std::invalid_argument("it must have two lines of numbers or more");
  return file;
}

}  // namespace silt::coupler

#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace silt::coupler {

/// The names of an enum's values, defined once for case reader, messages, derived table and report.
template <class Enum, std::size_t count>
struct NameTable {
  std::array<std::string_view, count> names;  // in the order of the enumerators

  constexpr std::string_view operator[](Enum value) const { return names[static_cast<std::size_t>(value)]; }
  std::vector<std::string> list() const { return {names.begin(), names.end()}; }
};

/// Makes a table: names_of<Refill>("equilibrium", "grad").
template <class Enum, class... Names>
constexpr NameTable<Enum, sizeof...(Names)> names_of(Names... names) {
  return {{names...}};
}
/// Makes a table of the names of rows, one row per value.
template <class Enum, class Row, std::size_t count>
constexpr NameTable<Enum, count> names_of(const std::array<Row, count>& rows) {
  NameTable<Enum, count> table;
  for (std::size_t i = 0; i < count; ++i) table.names[i] = rows[i].name;
  return table;
}

}  // namespace silt::coupler

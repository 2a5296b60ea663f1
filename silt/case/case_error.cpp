#include "silt/case/case_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

namespace silt {
namespace {

std::vector<Diagnostic> in_file_order(std::vector<Diagnostic> list) {
  std::ranges::stable_sort(list, {},
                           [](const Diagnostic& d) { return std::pair(d.place.line, d.place.column); });
  return list;
}

// Optimal string alignment distance: insertions, deletions, substitutions and swaps of neighbours cost one.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i)
    for (std::size_t j = 1; j <= b.size(); ++j) {
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

/// Returns whether one name contains the other, or both are short with one stem: "body", "bodies".
bool are_kin(std::string_view a, std::string_view b) {
  constexpr std::size_t stem = 3;  // letters: shorter parts are not significant
  const bool contain = a.find(b) != a.npos || b.find(a) != b.npos;
  const bool begin_alike = a.substr(0, stem) == b.substr(0, stem);
  return (contain && std::min(a.size(), b.size()) >= stem) ||
         (begin_alike && std::max(a.size(), b.size()) <= 2 * stem);
}

/// A symbol for a key in papers and other programs; its value, if the key has another.
struct Symbol {
  std::string_view written, key, value;
};
constexpr Symbol symbols[] = {{"nu", "kinematic_viscosity", ""},
                              {"mu", "dynamic_viscosity", ""},
                              {"eta", "dynamic_viscosity", ""},
                              {"tau", "relaxation_time", ""},
                              {"omega", "relaxation_time", " (1/omega)"},
                              {"omega", "angular_velocity", ""},
                              {"rho", "density", ""},
                              {"e", "restitution", ""},
                              {"mu", "friction", ""},
                              {"g", "acceleration", ""},
                              {"dx", "cell_size", ""},
                              {"dt", "time_step", ""}};

/// Returns the symbol of one of the names that is written so, or null.
const Symbol* symbol_for(std::string_view written, std::span<const std::string> names) {
  const auto found = std::ranges::find_if(symbols, [&](const Symbol& symbol) {
    return symbol.written == written && std::ranges::count(names, symbol.key) > 0;
  });
  return found == std::end(symbols) ? nullptr : found;
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

}  // namespace

std::string Diagnostic::line() const {
  return fmt::format("{}{}{}", place.file.empty() ? "" : place.text() + ": ",
                     severity == Severity::warning ? "warning: " : "", text);
}

CaseError::CaseError(std::vector<Diagnostic> list)
    : std::runtime_error(listed(in_file_order(list))), diagnostics_(in_file_order(std::move(list))) {}

CaseError::CaseError(const Place& place, const std::string& text)
    : CaseError(std::vector{Diagnostic{Diagnostic::Severity::error, place, text}}) {}

bool has_errors(std::span<const Diagnostic> list) {
  return std::ranges::any_of(list,
                             [](const Diagnostic& d) { return d.severity == Diagnostic::Severity::error; });
}

std::string listed(std::span<const Diagnostic> list) {
  std::vector<std::string> lines;
  for (const Diagnostic& d : list) lines.push_back(d.line());
  return joined(lines, "\n");
}

std::string nearest_name(std::string_view as_written, std::span<const std::string> names) {
  const std::string wanted = lower_case(as_written);
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(wanted.size() / 3, 1) + 1;
  for (const std::string& name : names)
    if (const std::size_t distance = edit_distance(wanted, name); distance < best_distance)
      best = name, best_distance = distance;
  if (best.empty())
    for (const std::string& name : names)
      if (best.empty() && are_kin(wanted, name)) best = name;
  if (best.empty()) {  // "viscocity" is far from "kinematic_viscosity" as a whole but close to its last word
    for (const std::string& name : names)
      for (std::size_t from = name.find('_'); from != name.npos; from = name.find('_', from + 1))
        if (best.empty() && edit_distance(wanted, name.substr(from + 1)) <= wanted.size() / 3) best = name;
  }
  return best;
}

std::string joined(std::span<const std::string> names, std::string_view separator) {
  return fmt::format("{}", fmt::join(names, separator));
}

std::string suggestion(std::string_view wanted, std::span<const std::string> names) {
  if (names.empty()) return "; none is known here";
  const Symbol* symbol = symbol_for(lower_case(wanted), names);
  const std::string nearest = symbol ? std::string(symbol->key) : nearest_name(wanted, names);
  return (nearest.empty() ? ";"
                          : fmt::format("; did you mean '{}'{}?", nearest, symbol ? symbol->value : "")) +
         " known: " + joined(names);
}

std::string shown(double x) {
  return fmt::format("{:.6g}", x);
}

}  // namespace silt

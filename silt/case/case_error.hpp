#pragma once
// A fault of a case: its place, what was found, what is allowed and what to do.
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "adapters/toml/document.hpp"

namespace silt {

using Place = adapters::Place;

struct Diagnostic {
  enum class Severity { error, warning };
  Severity severity = Severity::error;
  Place place;
  std::string text;

  /// Returns "cases/x/case.toml:12:5: fluid.density is -1; it must be above 0"; before the text of a warning
  /// there is "warning: ".
  std::string line() const;
};

/// The errors of a case. what() lists all diagnostics, one per line, in the order of the file.
class CaseError : public std::runtime_error {
 public:
  explicit CaseError(std::vector<Diagnostic>);
  CaseError(const Place&, const std::string& text);
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

bool has_errors(std::span<const Diagnostic>);
/// Returns one line per error or warning, in the given order.
std::string listed(std::span<const Diagnostic>);

/// Returns the name closest by edit distance (swapped neighbours count one, case is ignored), or "" if none
/// is close: over a third of the letters differ, neither contains the other, and stems differ.
std::string nearest_name(std::string_view as_written, std::span<const std::string> names);
/// Returns "a, b, c".
std::string joined(std::span<const std::string> names, std::string_view separator = ", ");
/// Returns "; did you mean 'kinematic_viscosity'? known: a, b, c", without the question if no name is close
/// and none has the written symbol ("nu").
std::string suggestion(std::string_view wanted, std::span<const std::string> names);
/// Returns x to six digits in the shortest form: 1e-06, 0.25.
std::string shown(double x);

}  // namespace silt

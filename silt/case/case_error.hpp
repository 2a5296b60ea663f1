#pragma once
// A diagnostic says what is wrong with a case: the place, what was found, what is allowed and what to do.
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

  /// Returns "cases/x/case.toml:12:5: fluid.density is -1; it must be above 0", with "warning: " before a
  /// warning's text.
  std::string line() const;
};

/// Says that a case cannot run. what() lists every diagnostic, one a line, in the order of the file.
class CaseError : public std::runtime_error {
 public:
  explicit CaseError(std::vector<Diagnostic>);
  CaseError(const Place&, const std::string& text);
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

bool has_errors(std::span<const Diagnostic>);
/// Returns one line each, errors and warnings in the order given.
std::string listed(std::span<const Diagnostic>);

/// Returns the name closest to one by edit distance (a swap of neighbours counts one, small letters are as
/// capitals), or "" if none is close: more than a third of the letters differ, neither begins with or
/// contains the other, and they are not of one stem.
std::string nearest_name(std::string_view as_written, std::span<const std::string> names);
/// Returns "a, b, c".
std::string joined(std::span<const std::string> names, std::string_view separator = ", ");
/// Returns "; did you mean 'kinematic_viscosity'? known: a, b, c", without the question if nothing is close
/// and what was written is a usual symbol ("nu") of none of them.
std::string suggestion(std::string_view wanted, std::span<const std::string> names);
/// Returns the shortest text that reads back as x to six digits: 1e-06, 0.25.
std::string shown(double x);

}  // namespace silt

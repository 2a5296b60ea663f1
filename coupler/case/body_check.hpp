#pragma once
// The part of check_case that looks at the bodies, but not at where the given ones are: shapes, sizes, fills.
#include <string>
#include <vector>

#include "coupler/case/case_error.hpp"

namespace silt::coupler {

struct Case;

/// Cells that given bodies may overlap something at the start: rounding of a case's numbers.
inline constexpr double start_overlap = 0.02;
/// Messages of one kind: more of them would say nothing new.
inline constexpr std::size_t most_messages = 10;

/// Gathers what checks find; keys are paths as in Case::places.
struct Findings {
  explicit Findings(const Case& scene) : scene(scene) {}
  void error(const std::string& key, const std::string& text) { add(Diagnostic::Severity::error, key, text); }
  void warning(const std::string& key, const std::string& text) {
    add(Diagnostic::Severity::warning, key, text);
  }
  void add(Diagnostic::Severity, const std::string& key, const std::string& text);

  const Case& scene;
  std::vector<Diagnostic> list;
};

/// Judges the sizes of the bodies, whether the backend can answer for their shapes, and the boxes of fills.
void find_body_faults(const Case&, Findings&);

}  // namespace silt::coupler

#pragma once
// The part of check_case that looks at the bodies: sizes, places, overlaps.
#include <string>
#include <vector>

#include "coupler/case/case_error.hpp"

namespace silt::coupler {

struct Case;

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

/// Judges sizes, places and overlaps of the bodies, and whether the backend can answer for their shapes.
void find_body_faults(const Case&, Findings&);

}  // namespace silt::coupler

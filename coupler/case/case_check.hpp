#pragma once
// Judges a case that could be read: refuses scenes that cannot run, warns of those that will run badly.
#include <fmt/format.h>

#include <string>
#include <vector>

#include "coupler/case/case_error.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

struct BodySpec;
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
  template <class... T>
  void error(const std::string& key, fmt::format_string<T...> text, T&&... values) {
    add(Diagnostic::Severity::error, key, fmt::format(text, std::forward<T>(values)...));
  }
  template <class... T>
  void warning(const std::string& key, fmt::format_string<T...> text, T&&... values) {
    add(Diagnostic::Severity::warning, key, fmt::format(text, std::forward<T>(values)...));
  }
  void add(Diagnostic::Severity, const std::string& key, const std::string& text);

  const Case& scene;
  std::vector<Diagnostic> list;
};

// How messages about bodies name their keys, places and lengths.

std::string body_name(const Case&, rigid::BodyId);  // "body 7"; "the wall 'bed'"; "the side z-low"
std::string entry_key(int entry);                   // "bodies[2]"
std::string position_key(const Case&, int entry);   // "bodies[2].position", or ".positions"
/// "bodies[2].position"; of a body from a file "bodies[2].positions, point 17 of cloud.csv".
std::string position_text(const Case&, const BodySpec&);
std::string shown_point(const Case&, const rigid::Vec3&);  // in the units of the case
std::string shown_length(const Case&, double);             // in the units of the case

/// "domain.boundary.z[0]", by the number of a side.
const char* side_key(int side);

/// Returns what is wrong with a body that at its start reaches further than `allowed` (cells) into a curved
/// wall, "" if it does not; `key` is what to change.
std::string fault_in_curved_walls(const Case&, const BodySpec&, const std::string& key, double allowed);

/// Returns everything that is wrong (errors) or doubtful (warnings) about a scene, by topic: domain and
/// blocks, fluid and boundaries, bodies, fills, run and output. A case with an error must not be started.
/// Where the bodies are is not looked at: that is for coupler/placement, each rank its own.
std::vector<Diagnostic> check_case(const Case&);

/// Judges as check_case; throws CaseError if there is an error, else returns the warnings.
std::vector<Diagnostic> require_runnable(const Case&);

}  // namespace silt::coupler

#pragma once
// Judges a case that could be read: refuses scenes that cannot run, warns of those that will run badly; and
// says what follows from it.
#include <fmt/format.h>

#include <string>
#include <vector>

#include "coupler/case/case_error.hpp"
#include "rigid/shapes/bounding_box.hpp"

namespace silt::coupler {

struct BodySpec;
struct Case;

/// Cells that given bodies may overlap something at the start: rounding of a case's numbers.
inline constexpr double start_overlap = 0.02;
/// Messages of one kind: more of them would say nothing new.
inline constexpr std::size_t most_messages = 10;

/// Gathers what checks find; keys are paths as in Case::places.
struct Findings {
  explicit Findings(const Case& setup) : setup(setup) {}
  template <class... T>
  void error(const std::string& key, fmt::format_string<T...> text, T&&... values) {
    add(Diagnostic::Severity::error, key, fmt::format(text, std::forward<T>(values)...));
  }
  template <class... T>
  void warning(const std::string& key, fmt::format_string<T...> text, T&&... values) {
    add(Diagnostic::Severity::warning, key, fmt::format(text, std::forward<T>(values)...));
  }
  void add(Diagnostic::Severity, const std::string& key, const std::string& text);

  const Case& setup;
  std::vector<Diagnostic> list;
};

// How messages about bodies name their keys, places and lengths.

std::string body_name(const Case&, rigid::BodyId);  // "body 7"; "the wall 'bed'"; "the side z-low"
std::string entry_key(int entry);                   // "bodies[2]"
std::string position_key(const Case&, int entry);   // "bodies[2].position", or ".positions"
/// "bodies[2].position"; of a body from a file "bodies[2].positions, point 17 of cloud.csv".
std::string position_text(const Case&, const BodySpec&);
std::string shown(const rigid::Vec3&);                          // "[0, 0, 9.81]"
std::string shown_point(const Case&, const rigid::Vec3&);       // in the units of the case
std::string shown_box(const Case&, const rigid::BoundingBox&);  // from corner to corner
std::string shown_length(const Case&, double);                  // in the units of the case

/// Says whether a box of some extent lies in the domain; it may reach `slack` cells beyond.
bool lies_in_domain(const Case&, const rigid::BoundingBox&, double slack);

/// "domain.boundary.z[0]", by the number of a side.
const char* side_key(int side);

/// Returns what is wrong with a body that at its start reaches further than `allowed` (cells) into a curved
/// wall, "" if it does not; `key` is what to change.
std::string fault_in_curved_walls(const Case&, const BodySpec&, const std::string& key, double allowed);

/// Returns everything that is wrong (errors) or doubtful (warnings) about a case, by topic: domain and
/// blocks, fluid and boundaries, bodies, fills, run and output. A case with an error must not be started.
/// Where the bodies are is not looked at: that is for coupler/placement, each rank its own.
std::vector<Diagnostic> check_case(const Case&);

/// Judges as check_case; throws CaseError if there is an error, else returns the warnings.
std::vector<Diagnostic> require_runnable(const Case&);

/// Returns the bytes of the fluid's populations (one array, D3Q19, updated in place) and of the map of solid
/// cells.
double fluid_memory(const Case&);

/// Returns a table of lines "name   in the units of the case   in lattice units": cells, time step,
/// relaxation time, sizes and expected speeds of each kind of body, memory, output. For `silt check` and the
/// head of run.log.
std::string derived_table(const Case&);

}  // namespace silt::coupler

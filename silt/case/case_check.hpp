#pragma once
// Judges a case that could be read: refuses scenes that cannot run, warns of those that will run badly; and
// says what follows from it.
#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

#include "rigid/math/types.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case_error.hpp"
#include "silt/case/units.hpp"

namespace silt {

struct BodySpec;
struct Case;

/// Cells that given bodies may overlap something at the start: rounding of a case's numbers.
inline constexpr double start_overlap = 0.02;
/// Messages of one kind: more of them would say nothing new.
inline constexpr std::size_t most_messages = 10;

/// Gathers what checks find; keys are paths as in Case::places.
struct Diagnostics {
  explicit Diagnostics(const Case& setup) : setup(setup) {}
  template <class... T>
  void error(const std::string& key, fmt::format_string<T...> text, T&&... values) {
    add(Diagnostic::Severity::error, key, fmt::format(text, std::forward<T>(values)...));
  }
  template <class... T>
  void warning(const std::string& key, fmt::format_string<T...> text, T&&... values) {
    add(Diagnostic::Severity::warning, key, fmt::format(text, std::forward<T>(values)...));
  }
  /// Warns of a key that is there and does nothing; `why` says what switches it off.
  void idle(const std::string& key, std::string_view why);
  void add(Diagnostic::Severity, const std::string& key, const std::string& text);

  const Case& setup;
  std::vector<Diagnostic> list;
};

// Messages about bodies name their keys, places and lengths in this way.

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

/// Returns what is wrong with a body that after so many steps reaches further than `allowed` (cells) into a
/// curved wall, "" if it does not; `key` is what to change.
std::string fault_in_curved_walls(const Case&, const BodySpec&, const std::string& key, double allowed,
                                  double time = 0);

/// Returns everything that is wrong (errors) or doubtful (warnings) about a case, by topic: domain and
/// blocks, fluid and boundaries, bodies, fills, run and output. A case with an error must not be started.
/// Where the bodies are is not looked at: that is for silt/placement, each rank its own.
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

// The cures of velocities and relaxation times that are out of range: the key by which a case gives the
// length of a step, with a value that is enough.

/// Returns "use units.time_step = 2.5e-05 (relaxation time 0.56)": steps that are `factor` times as long, or
/// a little shorter. Only in SI: a case in lattice units has no time step to choose, and the text is empty.
std::string time_step_cure(const Case&, double factor);

/// Returns "a smaller units.time_step", or what of another key makes steps shorter. Only in SI, else "".
std::string shorter_step(const Case&);

/// Return x to two digits, never above it (below it).
double rounded_down(double x);
double rounded_up(double x);

/// Limits in cells a step: the error by compressibility grows with the square of the speed.
inline constexpr double doubtful_velocity = 0.1, impossible_velocity = 0.3;
/// What a number may be beyond a limit: six digits, as messages have them, do not tell the two apart.
inline constexpr double unseen = 1e-6;
/// The deviation of the density above which the fluid is noticeably compressible.
inline constexpr double doubtful_deviation = 0.02;

/// Reports an error or a warning for a speed (cells a step) that the key gives and that is too high, with a
/// time step that makes it low enough.
void check_speed(Diagnostics&, const std::string& key, double speed);

/// Reports what is wrong with the velocities of a body of some shape; `entry`, "bodies[2].", goes before
/// their keys.
void check_velocities(Diagnostics&, const std::string& entry, int shape, const rigid::Vec3& velocity,
                      const rigid::Vec3& angular_velocity);

/// Returns " (0.25 m/s)", or nothing in lattice units.
std::string in_si(const Case&, double x, Dimension = dimension::velocity);

/// Returns the diameter of a sphere of a shape's volume.
double sphere_of_volume(const rigid::Shape&);

/// Returns the speed at which a sphere falls or rises steadily in unbounded fluid, by the drag law of
/// Schiller and Naumann (1933), C_D = 24/Re (1 + 0.15 Re^0.687). Lattice units; density relative to the
/// fluid's; negative never.
double terminal_velocity(double diameter, double density, double gravity, double kinematic_viscosity);

/// Bodies that move further in a step (cells) cover cells that no neighbour has seen. Only with a fluid.
inline constexpr double furthest_motion = 1;

/// The limits of a case, in cells a step, by the shape of a body. With a fluid furthest_motion. Without, in a
/// sub-step half of contacts.margin and half of the body's least width (of its thinnest part): then of two
/// bodies that were out of each other's reach before a sub-step none has passed the middle of the other after
/// it, nor the surface of a wall by its own middle, so that their contact pushes them back where they came
/// from.
class MotionLimits {
 public:
  explicit MotionLimits(const Case&);
  double of(int shape) const { return of_shape_[shape]; }
  double least() const { return least_; }
  /// Half of the least width of the thinnest part, in cells: what overlaps deeper than that is pushed out on
  /// the other side. Infinite for meshes.
  double half_width(int shape) const { return half_width_[shape]; }
  double least_half_width() const { return least_half_width_; }

 private:
  std::vector<double> of_shape_, half_width_;
  double least_, least_half_width_;
};

/// Returns the density, over the fluid's, from which on the explicit step is stable for a free body, within a
/// fifth for spheres: where the largest eigenvalue of M^-1 H, 5.13 / (D rho) for a sphere of D cells, is 0.40
/// sqrt(tau - 1/2) (scripts/accuracy/coupling_in_time.md; bounce-back bears twice as much). Of other shapes D
/// is the least width. 0 without a fluid, and where the coupling is implicit.
double least_explicit_density(const Case&, const rigid::Shape&);

/// Says whether any free body of the case is lighter than that.
bool has_bodies_too_light(const Case&);

}  // namespace silt

#pragma once
// Checks a case that was read: rejects scenes that cannot run, warns of poor ones, derives values.
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

/// Overlap of given bodies, in cells, that is allowed at the start for rounded numbers.
inline constexpr double start_overlap = 0.02;
/// The largest number of messages of one kind.
inline constexpr std::size_t most_messages = 10;

/// Collects errors and warnings; keys are paths as in Case::places.
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
  /// Warns of a key that has no effect; `why` says what switches it off.
  void idle(const std::string& key, std::string_view why);
  void add(Diagnostic::Severity, const std::string& key, const std::string& text);

  const Case& setup;
  std::vector<Diagnostic> list;
};

// Texts for messages about bodies: names, keys, places and lengths.

std::string body_name(const Case&, rigid::BodyId);  // "body 7"; "the wall 'bed'"; "the side z-low"
std::string entry_key(int entry);                   // "bodies[2]"
std::string position_key(const Case&, int entry);   // "bodies[2].position", or ".positions"
/// Returns "bodies[2].position" or, for a body of a file, "bodies[2].positions, point 17 of cloud.csv".
std::string position_text(const Case&, const BodySpec&);
std::string shown(const rigid::Vec3&);                          // "[0, 0, 9.81]"
std::string shown_point(const Case&, const rigid::Vec3&);       // in the units of the case
std::string shown_box(const Case&, const rigid::BoundingBox&);  // from corner to corner
std::string shown_length(const Case&, double);                  // in the units of the case

/// Returns whether a bounding box lies in the domain; it may extend `slack` cells beyond.
bool lies_in_domain(const Case&, const rigid::BoundingBox&, double slack);

/// Returns the longest cell that fits a domain of this size (m) with at least so many cells, a whole number,
/// along its shortest side; 0 if no cell in reach does.
double fitting_cell(const rigid::Vec3& size, double fewest);

/// Returns e.g. "domain.boundary.z[0]" for the number of a side.
const char* side_key(int side);

/// Returns the fault of a body that at `time` overlaps a curved wall by more than `allowed` cells, or "";
/// `key` is the key to change.
std::string fault_in_curved_walls(const Case&, const BodySpec&, const std::string& key, double allowed,
                                  double time = 0);

/// Returns all errors and warnings of a case by topic: domain and blocks, fluid and boundaries, bodies,
/// fills, run and output. A case with an error must not be started. silt/placement checks places of bodies.
std::vector<Diagnostic> check_case(const Case&);

/// Checks a case; throws CaseError if there is an error, else returns the warnings.
std::vector<Diagnostic> require_runnable(const Case&);

/// Returns the number of populations of a cell of fluid, with those of its temperature.
int populations_of(const Case&);
/// Returns the bytes of the fluid's populations, which are updated in place, and of the solid map.
double fluid_memory(const Case&);

/// Returns lines "name   value in the units of the case   in lattice units": cells, time step, relaxation
/// time, sizes and expected speeds of bodies, memory, output. For `silt check` and the head of run.log.
std::string derived_table(const Case&);

// Remedies for velocities and relaxation times out of range: a valid value of the key for the time step.

/// Returns "use units.time_step = 2.5e-05 (relaxation time 0.56)" for steps `factor` times as long, or
/// slightly shorter; "" for a case in lattice units.
std::string time_step_cure(const Case&, double factor);

/// Returns "a smaller units.time_step", or a change of another key that shortens steps; "" in lattice units.
std::string shorter_step(const Case&);
/// Returns "a larger units.time_step" and so on; "a longer time step" in lattice units.
std::string longer_step(const Case&);

/// Return x rounded to two digits, never above (below) it.
double rounded_down(double x);
double rounded_up(double x);

/// Limits in cells per step; the compressibility error grows with the square of the speed.
inline constexpr double doubtful_velocity = 0.1, impossible_velocity = 0.3;
/// The relative amount by which a number may exceed a limit: messages show six digits, which do not show it.
inline constexpr double unseen = 1e-6;
/// The deviation of the density above which the fluid is noticeably compressible.
inline constexpr double doubtful_deviation = 0.02;

/// Returns what is wrong where a speed (cells per step) carries heat across cells too fast for its scheme;
/// "": nothing.
std::string doubt_of_heat(const Case&, double speed);

/// Reports a speed (cells per step) of a key that is too high, with a suitable time step.
void check_speed(Diagnostics&, const std::string& key, double speed);

/// Reports errors and warnings for the velocities of a body; `entry` ("bodies[2].") precedes their keys.
void check_velocities(Diagnostics&, const std::string& entry, int shape, const rigid::Vec3& velocity,
                      const rigid::Vec3& angular_velocity);

/// Returns " (0.25 m/s)", or "" in lattice units.
std::string in_si(const Case&, double x, Dimension = dimension::velocity);

/// Returns the diameter of the sphere with a shape's volume.
double sphere_of_volume(const rigid::Shape&);

/// Returns the steady speed of a falling or rising sphere in unbounded fluid, by the drag law of Schiller and
/// Naumann (1933), C_D = 24/Re (1 + 0.15 Re^0.687). Lattice units, density relative to the fluid's.
double terminal_velocity(double diameter, double density, double gravity, double kinematic_viscosity);

/// Cells per step; a body that moves further covers cells without known neighbours. Only with a fluid.
inline constexpr double furthest_motion = 1;

/// The largest motions by shape, in cells per step. With a fluid furthest_motion. Without, half of
/// contacts.margin plus half of the least width of a body (of its thinnest part) per sub-step: then, if two
/// bodies are out of reach of each other, neither passes the middle of the other in a sub-step, and the
/// middle of a body passes no wall, so that contacts push them back.
class MotionLimits {
 public:
  explicit MotionLimits(const Case&);
  double of(int shape) const { return of_shape_[shape]; }
  double least() const { return least_; }
  /// Returns half of the least width of the thinnest part in cells; deeper overlaps are pushed out on the
  /// other side. Infinite for meshes.
  double half_width(int shape) const { return half_width_[shape]; }
  double least_half_width() const { return least_half_width_; }

 private:
  std::vector<double> of_shape_, half_width_;
  double least_, least_half_width_;
};

/// Returns the density, relative to the fluid, from which on explicit coupling is stable for a free body, to
/// 20 % for spheres: the largest eigenvalue of M^-1 H, 5.13 / (D rho) for a sphere of D cells, is 0.40
/// sqrt(tau - 1/2) (scripts/accuracy/coupling_in_time.md; twice as much with bounce-back). D is the least
/// width of other shapes. Returns 0 without a fluid or with implicit coupling.
double least_explicit_density(const Case&, const rigid::Shape&);

/// Returns whether a free body of the case is lighter.
bool has_bodies_too_light(const Case&);

// Numbers of SI cases that would be plausible in another unit. The functions return the
// remedy, "if gravity.acceleration is in mm/s2, write 9.81 (m/s2)", or "".

inline constexpr double thinnest = 5e-8, thickest = 0.5;              // m2/s: liquid metal to honey
inline constexpr double lightest_solid = 10, heaviest_solid = 25000;  // kg/m3: foam to osmium

inline bool is_of_a_solid(double density) {
  return density >= lightest_solid && density <= heaviest_solid;
}

/// For too viscous a fluid and for gravity 100 or 1000 times the Earth's.
std::string viscosity_slip(const Case&);
std::string gravity_slip(const Case&);
/// Both; if not "", this is the remedy for all that follows from them.
std::string motion_slip(const Case&);
/// For cells so large that the fluid's viscosity has no effect in them, or as wide as a hand.
std::string length_slip(const Case&);
/// For a motion that is too fast: the remedy for the units where they may be wrong, otherwise the given one.
std::string units_first(const Case&, const std::string& cure);
/// For the size of the domain in millimetres: "if domain.size is in mm, write [0.01, 0.01, 0.04] (m); else ".
std::string size_slip(const Case&);
/// For a surface from a file, named by an entry ("walls[0]"), that is so many cells across: far more than the
/// domain has.
std::string scale_slip(const Case&, const std::string& entry, double across);
/// For the density of a body (kg/m3) that the key gives, or of the fluid around it.
std::string density_slip(const Case&, const std::string& key, double density);

}  // namespace silt

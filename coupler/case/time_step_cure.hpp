#pragma once
// What to write where velocities, in cells a step, or the relaxation time are out of range: the key by which
// this case gives the length of a step, with a value that is enough.
#include <string>

namespace silt::coupler {

struct Case;

/// Returns "units.time_step", "units.relaxation_time" or "units.max_velocity", whichever the case has.
std::string time_step_key(const Case&);

/// Returns "use units.time_step = 2.5e-05 (relaxation time 0.56)": steps that are `factor` times as long, or
/// a little shorter. Only in SI: a case in lattice units has no time step to choose, and the text is empty.
std::string time_step_cure(const Case&, double factor);

/// Returns "a smaller units.time_step", or what of another key makes steps shorter. Only in SI, else "".
std::string shorter_step(const Case&);

/// Return x to two digits, never above it (below it).
double rounded_down(double x);
double rounded_up(double x);

}  // namespace silt::coupler

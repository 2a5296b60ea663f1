#pragma once
// What goes between this rank and the others, counted where it happens: traffic.cpp stands between the
// program and MPI (the profiling interface of the standard, chapter 15.2), so nothing that Silt or a library
// of its asks of MPI can be left out. A tool that counts in the same way sees the calls of an instrumented
// MPI only.
#include "rigid/bodies/traffic.hpp"

namespace silt::coupler {

using rigid::Traffic;

/// Returns the counts since the program began.
const Traffic& traffic();
/// Begins a step: what is under way now has been started in an earlier one.
void begin_step_of_traffic();

}  // namespace silt::coupler

#pragma once
// How fast this machine is now.

namespace silt::coupler {

/// Returns what a cell of the fluid takes in a step in single precision, in seconds: the median of five steps
/// of 96^3 cells on one core, some tens of milliseconds. MPI must have been started.
double seconds_of_a_cell();

}  // namespace silt::coupler

#pragma once
// What goes between this rank and the others, counted where it happens: traffic.cpp stands between the
// program and MPI (the profiling interface of the standard, chapter 15.2), so nothing that Silt or a library
// of its asks of MPI can be left out. A tool that counts in the same way sees the calls of an instrumented
// MPI only.
#include <cstdint>

namespace silt::coupler {

/// Counts of this rank. What concerns a communicator of one rank is not counted.
struct Traffic {
  std::uint64_t messages = 0;        // sent point to point
  std::uint64_t empty_messages = 0;  // of them, without a byte
  std::uint64_t bytes = 0;           // in them
  /// Collectives that this rank could not leave before every other had come: blocking ones, and nonblocking
  /// ones that ended in the step that started them.
  std::uint64_t blocking_collectives = 0;
  std::uint64_t collectives_under_way = 0;  // nonblocking ones that ended in a later step
  double waited = 0;                        // seconds in calls that wait for another rank, or ask for one

  Traffic& operator+=(const Traffic&);
  Traffic operator-(const Traffic&) const;
};

/// Returns the counts since the program began.
const Traffic& traffic();
/// Begins a step: what is under way now has been started in an earlier one.
void begin_step_of_traffic();

}  // namespace silt::coupler

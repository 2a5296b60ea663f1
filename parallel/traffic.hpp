#pragma once
// Counts of the messages between this rank and the others, all of which go through parallel/
// (tests/layering.py). It includes no MPI: the step of the bodies reads the counts, too.
#include <cstdint>

namespace silt::parallel {

/// Counts of one rank. What concerns a communicator of one rank is not counted.
struct Traffic {
  std::uint64_t messages = 0;        // sent point to point
  std::uint64_t empty_messages = 0;  // of them, without a byte
  std::uint64_t bytes = 0;           // in them
  /// Collectives that this rank could not leave before every other had come: blocking ones, and nonblocking
  /// ones that ended in the step that started them.
  std::uint64_t blocking_collectives = 0;
  std::uint64_t collectives_under_way = 0;  // nonblocking ones that ended in a later step
  double waited = 0;                        // seconds in calls that wait for another rank, or ask for one

  Traffic& operator+=(const Traffic& t) {
    messages += t.messages;
    empty_messages += t.empty_messages;
    bytes += t.bytes;
    blocking_collectives += t.blocking_collectives;
    collectives_under_way += t.collectives_under_way;
    waited += t.waited;
    return *this;
  }
  Traffic operator-(const Traffic& t) const {
    return {messages - t.messages,
            empty_messages - t.empty_messages,
            bytes - t.bytes,
            blocking_collectives - t.blocking_collectives,
            collectives_under_way - t.collectives_under_way,
            waited - t.waited};
  }
};

namespace counting {
inline Traffic so_far;
inline std::uint64_t step = 0;
}  // namespace counting

inline const Traffic& traffic() {
  return counting::so_far;
}
/// Begins a step: what is under way now has been started in an earlier one.
inline void begin_step_of_traffic() {
  ++counting::step;
}

}  // namespace silt::parallel

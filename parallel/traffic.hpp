#pragma once
// Counts of this rank's messages, all of which go through parallel/ (tests/layering.py). Without MPI, since
// the step of the bodies reads the counts, too.
#include <cstdint>

namespace silt::parallel {

/// Counts of one rank, except on communicators of one rank.
struct Traffic {
  std::uint64_t messages = 0;        // sent point to point
  std::uint64_t empty_messages = 0;  // those without a byte
  std::uint64_t bytes = 0;           // of all messages
  /// Collectives that synchronised this rank with all others: blocking ones, and nonblocking ones that ended
  /// in the step in which they were started.
  std::uint64_t blocking_collectives = 0;
  std::uint64_t collectives_under_way = 0;  // nonblocking ones that ended in a later step
  double waited = 0;                        // seconds in calls that wait for, or test for, another rank

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
/// Begins a step. Collectives under way now were started in an earlier step.
inline void begin_step_of_traffic() {
  ++counting::step;
}

}  // namespace silt::parallel

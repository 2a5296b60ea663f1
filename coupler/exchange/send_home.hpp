#pragma once
// Bodies that lie anywhere, as those of a checkpoint, go to the ranks that will own them.
#include <vector>

#include "coupler/exchange/holders.hpp"
#include "parallel/messages.hpp"
#include "rigid/bodies/body_set.hpp"

namespace silt::coupler {

/// Bodies apart from a body set: records, and as many lists of stored impulses.
struct SavedBodies {
  std::vector<rigid::BodyRecord> records;
  std::vector<std::vector<rigid::StoredImpulse>> impulses;
};

/// Collective. Adds to `bodies`, as owned rows, those of the saved bodies of all ranks whose centre of mass
/// lies in this rank's blocks. Each body is saved on exactly one rank, whichever. They go in rounds of
/// `at_once` bodies a rank, so that the messages take little memory beside the bodies.
void send_home(parallel::Messages&, const Holders&, const SavedBodies&, rigid::BodySet& bodies,
               std::size_t at_once = std::size_t{1} << 14);

}  // namespace silt::coupler

#pragma once
// Bodies that lie anywhere, as those of a checkpoint or of other cuts, go to the ranks that will own them.
#include <vector>

#include "coupler/exchange/holders.hpp"
#include "parallel/messages.hpp"
#include "rigid/bodies/body_set.hpp"

namespace silt::coupler {

/// A body with all that only its owner has.
struct OwnedBody {
  rigid::BodyRecord record;
  rigid::FixedVec3 force = {}, torque = {};
  std::vector<rigid::StoredImpulse> impulses = {};
};
void put_body(parallel::Bytes& to, const OwnedBody&);
OwnedBody take_body(parallel::ByteReader& from);

/// Collective. Each rank gives bodies, and gets those of all ranks whose centre of mass lies in its blocks,
/// its own ones first.
std::vector<OwnedBody> sent_home(parallel::Messages&, const Holders&, std::vector<OwnedBody> given);

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

#pragma once
// Checks the invariants of owners and copies. Used by the guard, with SILT_ASSERTS in each step.
#include <mpi.h>

#include <string>

#include "coupler/exchange/parallel_body_exchange.hpp"
#include "parallel/pending_sums.hpp"

namespace silt::coupler {

/// A fingerprint of the owned bodies; its sum over ranks is constant if every body has exactly one owner.
struct OwnedBodies {
  std::uint64_t count = 0, ids = 0;  // number; wrapping sum of the hashes of ids
  bool operator==(const OwnedBodies&) const = default;
};

/// This rank's share of the bodies that all ranks together must own. Shares need not agree with ownership,
/// only their sum, so that bodies come and go without messages.
class ExpectedBodies {
 public:
  explicit ExpectedBodies(const rigid::BodySet&);  // those owned here now
  /// Adds n new ids, whoever owns them. Every rank calls this with the same arguments and takes a part.
  void add(rigid::BodyId first, std::uint64_t n, int rank, int ranks);
  void remove(rigid::BodyId);  // called by the owner
  /// Returns the bodies owned here in excess of this share; the sum over all ranks must be zero.
  OwnedBodies excess(const rigid::BodySet&) const;
  std::uint64_t count(MPI_Comm) const;  // of all ranks; collective

 private:
  OwnedBodies share_;
};

/// Checks that every body has one owner, the rank that contains its centre; that their number is as expected;
/// that sections are sorted and found by id; and that copies equal their owners bitwise. A check starts after
/// one step and ends in a later one, so that no rank waits for all others.
class PendingCheck {
 public:
  /// Checks this rank's bodies, exchanging messages with ranks that hold their copies, and starts the sum of
  /// the results. Collective, but waits for no other rank.
  void start(ParallelBodyExchange&, const rigid::BodySet&, const ExpectedBodies&, std::int64_t step);
  /// Throws std::logic_error, the same on every rank, with the step (unless negative), the body and the
  /// ranks, from the current bodies. Does nothing unless a check is under way. Collective.
  void finish(const ParallelBodyExchange&, const rigid::BodySet&, const ExpectedBodies&);

 private:
  struct Sums {
    OwnedBodies excess;     // over the expected bodies
    std::int64_t findings;  // number of ranks with another error
  };
  parallel::PendingSums<Sums> sums_;
  rigid::BodyId bad_ = 0;  // this rank's faulty body, and its error
  std::string text_;
  std::int64_t step_ = 0;
};

/// Makes the whole check at once, after a synchronisation. Collective.
void check_exchange(ParallelBodyExchange&, const rigid::BodySet&, const ExpectedBodies&);

}  // namespace silt::coupler

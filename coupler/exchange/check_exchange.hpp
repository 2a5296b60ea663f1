#pragma once
// The invariants of owner and remote bodies. Simulation checks them at every look of the guard, builds with
// SILT_ASSERTS after every synchronisation.
#include <mpi.h>

#include <string>

#include "coupler/exchange/parallel_body_exchange.hpp"
#include "parallel/sums_under_way.hpp"

namespace silt::coupler {

/// The bodies that all ranks own: equal before and after a synchronisation if every body has exactly one
/// owner.
struct OwnedBodies {
  std::uint64_t count = 0, ids = 0;  // how many; wrapping sum of their ids' hashes
  bool operator==(const OwnedBodies&) const = default;
};

/// A rank's share of the bodies that all ranks together must own. Which rank expects one does not matter, but
/// one of them does: so bodies come and go without a word to all.
class ExpectedBodies {
 public:
  explicit ExpectedBodies(const rigid::BodySet&);  // those owned here now
  /// Bodies of n new ids have come, on whichever ranks. Every rank says so alike and takes a part of them.
  void come(rigid::BodyId first, std::uint64_t n, int rank, int ranks);
  void leave(rigid::BodyId);  // is called by its owner
  /// Returns what is owned here beyond this share: zero, if summed over all ranks.
  OwnedBodies excess(const rigid::BodySet&) const;
  std::uint64_t count(MPI_Comm) const;  // of all ranks; collective

 private:
  OwnedBodies share_;
};

/// Checks that every body has one owner, the rank that holds its centre; that there are as many as expected;
/// that sections of bodies are sorted and found by their ids; that copies are bitwise their owners'
/// bodies. The check begins after one step and ends in a later one, so that no rank waits for all.
class CheckUnderWay {
 public:
  /// Looks at this rank's bodies, with messages to ranks that hold their copies, and starts the sums that
  /// tell whether all is well. Collective, but waits for nobody else.
  void start(const ParallelBodyExchange&, const rigid::BodySet&, const ExpectedBodies&, std::int64_t step);
  /// Throws std::logic_error, the same on every rank, that names the step (where not negative), the body and
  /// the ranks; the bodies are those of now. Nothing, if no check is under way. Collective.
  void finish(const ParallelBodyExchange&, const rigid::BodySet&, const ExpectedBodies&);

 private:
  struct Sums {
    OwnedBodies excess;     // over those expected
    std::int64_t findings;  // ranks that found something else
  };
  parallel::SumsUnderWay<Sums> sums_;
  rigid::BodyId bad_ = 0;  // on this rank, and what is wrong with it
  std::string text_;
  std::int64_t step_ = 0;
};

/// Checks all of this at once, after a synchronisation. Collective.
void check_exchange(const ParallelBodyExchange&, const rigid::BodySet&, const ExpectedBodies&);

}  // namespace silt::coupler

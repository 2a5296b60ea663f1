#pragma once
// The invariants of owner and remote bodies, as figures to compare: checked after every synchronisation in
// builds with SILT_ASSERTS, and by the tests.
#include <mpi.h>

#include "coupler/exchange/body_exchange.hpp"

namespace silt::coupler {

/// Hash of everything a record holds, bit by bit.
std::uint64_t hash_of(const rigid::BodyRecord&);

/// What all ranks own: equal before and after a synchronisation if every body has exactly one owner.
struct OwnedBodies {
  std::uint64_t count = 0, ids = 0;  // how many; wrapping sum of their ids' hashes
  bool operator==(const OwnedBodies&) const = default;
};
OwnedBodies count_owned(MPI_Comm, const rigid::BodySet&);  // collective

/// Wrapping sum over all owned bodies of the hashes of their records (mapping pose included) and, where
/// asked for, of their stored impulses: the same on any number of ranks. Collective.
std::uint64_t state_hash(MPI_Comm, const rigid::BodySet&, bool stored_impulses = true);

/// Throws std::logic_error with what is wrong on this rank: rows out of order, a body that is not where its
/// owner is, a copy that differs from its owner's row. Collective.
void check_bodies(const BodyExchange&, const rigid::BodySet&);

}  // namespace silt::coupler

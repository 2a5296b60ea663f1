#pragma once
// The bodies that a case gives one by one, on the ranks that need them; reports of faults of all ranks.
#include <mpi.h>

#include <span>
#include <string>
#include <vector>

#include "coupler/exchange/holders.hpp"
#include "lbm/blocks/domain.hpp"
#include "parallel/collectives.hpp"
#include "parallel/messages.hpp"
#include "silt/case/case.hpp"

namespace silt {

/// A rank that places bodies: its part of the domain and its neighbour ranks.
struct Surroundings {
  /// `reach` is the distance in cells from a rank's blocks within which it needs bodies. Collective.
  Surroundings(const Case& setup, const lbm::Domain& domain, MPI_Comm comm, double reach)
      : domain(domain),
        extent(extent_of(setup)),
        holders(domain, reach),
        messages(comm),
        rank(parallel::rank_of(comm)),
        ranks(parallel::ranks_of(comm)) {}

  MPI_Comm comm() const { return messages.comm(); }
  bool is_here(const rigid::Vec3& x_W) const { return holders.rank_at(x_W) == rank; }
  /// Returns the ranks within reach of a box; valid until the next call.
  const std::vector<int>& ranks_near(const rigid::BoundingBox& box) {
    holders.ranks_of(box, near_);
    return near_;
  }
  /// Adds a value to the messages to other ranks within reach of a box; returns whether there are any.
  template <class T>
  bool tell_others_near(const rigid::BoundingBox& box, const T& value) {
    bool any = false;
    for (const int other : ranks_near(box))
      if (other != rank) parallel::put(messages.to(other), value), any = true;
    return any;
  }
  /// Returns the sum over ranks. Collective.
  std::uint64_t sum(std::uint64_t mine) const { return parallel::sum_over_ranks(comm(), mine); }

  const lbm::Domain& domain;
  const rigid::Extent extent;
  const coupler::Holders holders;
  parallel::Messages messages;
  const int rank, ranks;

 private:
  std::vector<int> near_;
};

/// A body given by the case, or an existing one when others arrive.
struct GivenBody {
  rigid::BodyId id;
  BodySpec spec;
  bool own;  // its centre of mass is on this rank
};

/// Returns the given bodies that this rank owns or that come near it, by id. Ids from 1 on: bodies with
/// positions in the case, then those of files, both in the order of the case. Collective.
std::vector<GivenBody> given_bodies(const Case&, Surroundings&);
/// Adds the bodies of files. Each rank reads a slice of each file and sends every body to the ranks that need
/// it, in rounds of `at_once` bodies per rank, which limits memory. Throws CaseError with file and point on
/// every rank. Collective.
void add_filed_bodies(const Case&, Surroundings&, std::vector<GivenBody>&, std::size_t at_once = 1 << 16);
/// Returns the mean diameter of the bounding spheres, at least one cell, for the edge of a NeighbourGrid.
double mean_width(const Case&, std::span<const GivenBody>);
/// Returns the number of given bodies on all ranks.
std::uint64_t count_given(const Case&);
/// Returns the entry of [[bodies]] that gave a body.
int entry_of(const Case&, rigid::BodyId);

/// Returns the fault of a body's place, or "". Its centre of mass must be in the domain and, if it moves, it
/// must not overlap walls at `time`. `key` is the key to change.
std::string fault_of_place(const Case&, const BodySpec&, const std::string& key, double time = 0);

struct BodyFault {
  rigid::BodyId body, other = 0;  // other: 0 if none
  std::string text;
};
/// Returns the first `most` faults of all ranks by (body, other), without repetitions. Collective.
std::vector<BodyFault> first_faults(MPI_Comm, std::vector<BodyFault> mine, std::size_t most);

/// Throws CaseError on every rank if given bodies have their centre outside the domain, overlap a wall or,
/// only if there are none of those, overlap each other; lists the first few of a kind in the order of the
/// case. The case must have passed check_case. Collective.
void require_sound_start(const Case&, const lbm::Domain&, MPI_Comm);

/// Throws CaseError on every rank if bodies of another run, given by shares of the ranks, overlap given
/// bodies or [[walls]] that are new. Collective.
void require_room_beside(std::span<const rigid::BodyRecord> there, bool walls_are_new, const Case&,
                         const lbm::Domain&, MPI_Comm);

}  // namespace silt

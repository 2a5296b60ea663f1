#pragma once
// The bodies that a case gives one by one, on the ranks they concern, and how ranks tell what is wrong with
// them.
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

/// A rank that places bodies: its part of the domain, and the ranks about it.
struct Surroundings {
  /// Collective. reach: cells from a rank's blocks at which another's bodies concern it.
  Surroundings(const Case& setup, const lbm::Domain& domain, MPI_Comm comm, double reach)
      : domain(domain),
        extent(extent_of(setup)),
        holders(domain, reach),
        messages(comm),
        rank(parallel::rank_of(comm)),
        ranks(parallel::ranks_of(comm)) {}

  MPI_Comm comm() const { return messages.comm(); }
  bool is_here(const rigid::Vec3& x_W) const { return holders.rank_at(x_W) == rank; }
  /// Ranks within reach of a box; valid until the next call.
  const std::vector<int>& ranks_near(const rigid::BoundingBox& box) {
    holders.ranks_of(box, near_);
    return near_;
  }
  /// Puts a value into the messages to the other ranks within reach of a box; returns whether there are any.
  template <class T>
  bool tell_others_near(const rigid::BoundingBox& box, const T& value) {
    bool any = false;
    for (const int other : ranks_near(box))
      if (other != rank) parallel::put(messages.to(other), value), any = true;
    return any;
  }
  /// Collective.
  std::uint64_t sum(std::uint64_t mine) const { return parallel::sum_over_ranks(comm(), mine); }

  const lbm::Domain& domain;
  const rigid::Extent extent;
  const coupler::Holders holders;
  parallel::Messages messages;
  const int rank, ranks;

 private:
  std::vector<int> near_;
};

/// A body that the case gives, or that is there already when others come.
struct GivenBody {
  rigid::BodyId id;
  BodySpec spec;
  bool own;  // its centre of mass is here
};

/// Collective. Returns the given bodies that this rank owns or that reach near it, in the order of ids: from
/// 1 on, first those whose positions the case says, then those of files, each in the order of the case.
std::vector<GivenBody> given_bodies(const Case&, Surroundings&);
/// Collective. Adds those of files. Each rank reads a slice of each file and sends every body to the ranks it
/// concerns, in rounds of `at_once` a rank: none ever has more than its slice, and its own. CaseError on
/// every rank names file and point.
void add_filed_bodies(const Case&, Surroundings&, std::vector<GivenBody>&, std::size_t at_once = 1 << 16);
/// Returns the mean diameter of their bounding spheres, at least a cell: what suits a grid of them.
double mean_width(const Case&, std::span<const GivenBody>);
/// Returns how many there are on all ranks.
std::uint64_t count_given(const Case&);
/// Returns which entry of [[bodies]] gave one.
int entry_of(const Case&, rigid::BodyId);

/// Returns what is wrong with the place of a body, "" if nothing: its centre of mass must be in the domain,
/// and if it moves it must not reach into a wall, where walls are after so many steps. `key` is what to
/// change.
std::string fault_of_place(const Case&, const BodySpec&, const std::string& key, double time = 0);

struct BodyFault {
  rigid::BodyId body, other = 0;  // other: 0 if there is none
  std::string text;
};
/// Collective. Returns the first `most` faults by (body, other), each once though several ranks may have
/// found it.
std::vector<BodyFault> first_faults(MPI_Comm, std::vector<BodyFault> mine, std::size_t most);

struct Case;

/// Collective. CaseError on every rank says which given bodies have their centre outside the domain, reach
/// into a wall or, if there are none of those, overlap another: of each kind the first few, by the order of
/// the case. The case must have passed check_case.
void require_sound_start(const Case&, const lbm::Domain&, MPI_Comm);

/// Collective. CaseError on every rank says which bodies of another run, of which each rank has some, a given
/// body overlaps, or reach into [[walls]] that were not there.
void require_room_beside(std::span<const rigid::BodyRecord> there, bool walls_are_new, const Case&,
                         const lbm::Domain&, MPI_Comm);

}  // namespace silt

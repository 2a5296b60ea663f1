#pragma once
// A rank that places bodies: its part of the domain, and the ranks about it.
#include "coupler/case/case.hpp"
#include "coupler/exchange/holders.hpp"
#include "parallel/collectives.hpp"
#include "parallel/messages.hpp"

namespace silt::coupler {

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
  /// Collective: the sum over all ranks.
  std::uint64_t sum(std::uint64_t mine) const { return parallel::sum_over_ranks(comm(), mine); }

  const lbm::Domain& domain;
  const rigid::Extent extent;
  const Holders holders;
  parallel::Messages messages;
  const int rank, ranks;

 private:
  std::vector<int> near_;
};

}  // namespace silt::coupler

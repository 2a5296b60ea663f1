#pragma once
// A rank that places bodies: its part of the domain, and the ranks about it.
#include "coupler/exchange/holders.hpp"
#include "parallel/messages.hpp"
#include "rigid/bodies/body_exchange.hpp"

namespace silt::coupler {

struct Case;

struct Surroundings {
  /// Collective. reach: cells from a rank's blocks at which another's bodies concern it.
  Surroundings(const Case&, const lbm::Domain&, MPI_Comm, double reach);

  MPI_Comm comm() const { return messages.comm(); }
  bool is_here(const rigid::Vec3& x_W) const { return holders.rank_at(x_W) == rank; }
  /// Ranks within reach of a box; valid until the next call.
  const std::vector<int>& ranks_near(const rigid::BoundingBox&);
  std::uint64_t sum(std::uint64_t) const;  // over all ranks; collective

  const lbm::Domain& domain;
  const rigid::Extent extent;
  const Holders holders;
  parallel::Messages messages;
  const int rank, ranks;

 private:
  std::vector<int> near_;
};

}  // namespace silt::coupler

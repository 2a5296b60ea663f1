#include "coupler/placement/surroundings.hpp"

#include "coupler/case/case.hpp"
#include "parallel/collectives.hpp"

namespace silt::coupler {

Surroundings::Surroundings(const Case& scene, const lbm::Domain& domain, MPI_Comm comm, double reach)
    : domain(domain),
      extent(extent_of(scene)),
      holders(domain, reach),
      messages(comm),
      rank(parallel::rank_of(comm)),
      ranks(parallel::ranks_of(comm)) {}

const std::vector<int>& Surroundings::ranks_near(const rigid::BoundingBox& box) {
  holders.ranks_of(box, near_);
  return near_;
}

std::uint64_t Surroundings::sum(std::uint64_t mine) const {
  return parallel::sum_over_ranks(comm(), mine);
}

}  // namespace silt::coupler

#include "coupler/placement/surroundings.hpp"

#include "coupler/case/case_extent.hpp"
#include "coupler/exchange/reduce.hpp"

namespace silt::coupler {

Surroundings::Surroundings(const Case& scene, const lbm::Domain& domain, MPI_Comm comm, double reach)
    : domain(domain), extent(extent_of(scene)), holders(domain, reach), messages(comm) {
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
}

const std::vector<int>& Surroundings::ranks_near(const rigid::BoundingBox& box) {
  holders.ranks_of(box, near_);
  return near_;
}

std::uint64_t Surroundings::sum(std::uint64_t mine) const {
  sum_over_ranks(comm(), std::span(&mine, 1));
  return mine;
}

}  // namespace silt::coupler

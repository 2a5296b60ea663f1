#include "coupler/exchange/parallel_body_exchange.hpp"

#include "coupler/exchange/check_exchange.hpp"
#include "coupler/exchange/distribution.hpp"
#include "coupler/exchange/traffic.hpp"

namespace silt::coupler {

namespace {

rigid::Extent extent_of(const lbm::Domain& domain) {
  rigid::Extent extent;
  for (int d = 0; d < 3; ++d) {
    extent.size[d] = domain.cells()[d];
    extent.periodic[d] = domain.periodic(d);
  }
  return extent;
}

#ifdef SILT_ASSERTS
constexpr bool asserts = true;
#else
constexpr bool asserts = false;
#endif

}  // namespace

ParallelBodyExchange::ParallelBodyExchange(MPI_Comm comm, const lbm::Domain& domain,
                                           const rigid::World& world, double rim)
    : rigid::BodyExchange(extent_of(domain)), comm_(comm), domain_(domain), world_(world), rim_(rim) {
  MPI_Comm_rank(comm_, &rank_);
  MPI_Comm_size(comm_, &ranks_);
  if (ranks_ > 1) distribution_ = std::make_shared<Distribution>(comm_, rank_, domain_, world_, rim_);
}

void ParallelBodyExchange::sum_forces(rigid::BodySet& bodies) {
  if (distribution_) distribution_->sum_forces(bodies);
}

void ParallelBodyExchange::synchronise(rigid::BodySet& bodies) {
  rigid::BodyExchange::synchronise(bodies);
  if (!distribution_) return;
  OwnedBodies before;
  if (asserts) before = count_owned(comm_, bodies);
  distribution_->synchronise(bodies);
  if (asserts) check_exchange(*this, bodies, before);
}

void ParallelBodyExchange::distribute(rigid::BodySet& bodies) {
  rigid::BodyExchange::synchronise(bodies);
  if (distribution_) distribution_->distribute(bodies);
}

int ParallelBodyExchange::rank_at(const rigid::Vec3& x_W) const {
  return distribution_ ? distribution_->holders.rank_at(x_W) : 0;
}

bool ParallelBodyExchange::owns_contact_at(const rigid::Vec3& x_W) const {
  return rank_at(x_W) == rank_;
}

int ParallelBodyExchange::owner_of(const rigid::BodySet& bodies, std::size_t row) const {
  return row < bodies.owned || !distribution_ ? rank_ : distribution_->owner(bodies.id[row]);
}

std::vector<int> ParallelBodyExchange::holders(int shape, const rigid::Pose& pose) const {
  std::vector<int> ranks{0};
  if (distribution_) distribution_->find_holders(shape, pose, ranks);
  return ranks;
}

void ParallelBodyExchange::exchange_contacts(rigid::BodySet& bodies, std::vector<rigid::Contact>& contacts) {
  if (distribution_) distribution_->exchange_contacts(bodies, contacts);
}

void ParallelBodyExchange::share(rigid::BodySet&, std::span<double> rows, int width) {
  if (distribution_) distribution_->share(rows, width);
}

void ParallelBodyExchange::sum_to_owners(const rigid::BodySet& bodies, std::span<std::int64_t> rows,
                                         int width) const {
  if (distribution_) distribution_->sum_to_owners(bodies, rows, width);
}

void ParallelBodyExchange::share_with_copies(const rigid::BodySet& bodies, std::span<double> rows,
                                             int width) const {
  if (distribution_) distribution_->share_with_copies(bodies, rows, width);
}

double ParallelBodyExchange::maximum(double x) const {
  if (!distribution_) return x;
  double largest = x;
  MPI_Allreduce(&x, &largest, 1, MPI_DOUBLE, MPI_MAX, comm_);
  return largest;
}

double ParallelBodyExchange::waited() const {
  return traffic().waited;
}

const ExchangeCounters& ParallelBodyExchange::counters() const {
  if (distribution_) {
    counters_ = distribution_->counters;
    counters_.messages = distribution_->messages.messages_sent();
    counters_.bytes = distribution_->messages.bytes_sent();
  }
  return counters_;
}

}  // namespace silt::coupler

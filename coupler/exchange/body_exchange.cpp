#include "coupler/exchange/body_exchange.hpp"

#include <stdexcept>

#include "coupler/exchange/check_exchange.hpp"
#include "coupler/exchange/parallel_bodies.hpp"

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

BodyExchange::BodyExchange(MPI_Comm comm, const lbm::Domain& domain, const rigid::World& world, double rim)
    : rigid::BodyExchange(extent_of(domain)), comm_(comm), domain_(domain), world_(world), rim_(rim) {
  MPI_Comm_rank(comm_, &rank_);
  MPI_Comm_size(comm_, &ranks_);
  if (ranks_ > 1) parallel_ = std::make_shared<Parallel>(comm_, rank_, domain_, world_, rim_);
}

void BodyExchange::sum_forces(rigid::BodySet& bodies) {
  if (parallel_) parallel_->sum_forces(bodies);
}

void BodyExchange::synchronise(rigid::BodySet& bodies) {
  rigid::BodyExchange::synchronise(bodies);
  if (!parallel_) return;
  OwnedBodies before;
  if (asserts) before = count_owned(comm_, bodies);
  parallel_->synchronise(bodies);
  if (!asserts) return;
  if (count_owned(comm_, bodies) != before)
    throw std::logic_error("bodies were lost or doubled between ranks");
  check_bodies(*this, bodies);
}

void BodyExchange::distribute(rigid::BodySet& bodies) {
  rigid::BodyExchange::synchronise(bodies);
  if (parallel_) parallel_->distribute(bodies);
}

int BodyExchange::rank_at(const rigid::Vec3& x_W) const {
  return parallel_ ? parallel_->holders.rank_at(x_W) : 0;
}

bool BodyExchange::owns_contact_at(const rigid::Vec3& x_W) const {
  return rank_at(x_W) == rank_;
}

std::vector<int> BodyExchange::holders(int shape, const rigid::Pose& pose) const {
  std::vector<int> ranks{0};
  if (parallel_) parallel_->find_holders(shape, pose, ranks);
  return ranks;
}

void BodyExchange::exchange_contacts(rigid::BodySet& bodies, std::vector<rigid::Contact>& contacts) {
  if (parallel_) parallel_->exchange_contacts(bodies, contacts);
}

void BodyExchange::share(rigid::BodySet&, std::span<double> rows, int width) {
  if (parallel_) parallel_->share(rows, width);
}

void BodyExchange::sum_to_owners(const rigid::BodySet& bodies, std::span<std::int64_t> rows,
                                 int width) const {
  if (parallel_) parallel_->sum_to_owners(bodies, rows, width);
}

void BodyExchange::share_with_copies(const rigid::BodySet& bodies, std::span<double> rows, int width) const {
  if (parallel_) parallel_->share_with_copies(bodies, rows, width);
}

double BodyExchange::maximum(double x) const {
  if (!parallel_) return x;
  double largest = x;
  MPI_Allreduce(&x, &largest, 1, MPI_DOUBLE, MPI_MAX, comm_);
  return largest;
}

const ExchangeCounters& BodyExchange::counters() const {
  if (parallel_) {
    counters_ = parallel_->counters;
    counters_.messages = parallel_->messages.messages_sent();
    counters_.bytes = parallel_->messages.bytes_sent();
  }
  return counters_;
}

}  // namespace silt::coupler

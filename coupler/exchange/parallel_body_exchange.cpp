#include "coupler/exchange/parallel_body_exchange.hpp"

#include "coupler/exchange/check_exchange.hpp"
#include "coupler/exchange/distribution.hpp"
#include "parallel/communicator.hpp"

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
  rank_ = parallel::rank_of(comm_);
  ranks_ = parallel::ranks_of(comm_);
  if (ranks_ > 1) distribution_ = std::make_shared<Distribution>(comm_, rank_, domain_, world_, rim_);
}

void ParallelBodyExchange::update_copies(rigid::BodySet& bodies) {
  wrap_positions(bodies);
  if (distribution_) distribution_->synchronise(bodies, Distribution::Owners::stay);
}

void ParallelBodyExchange::synchronise(rigid::BodySet& bodies) {
  wrap_positions(bodies);
  if (!distribution_) return;
  OwnedBodies before;
  if (asserts) before = count_owned(comm_, bodies);
  distribution_->synchronise(bodies, Distribution::Owners::next_to_each_other);
  if (asserts) check_exchange(*this, bodies, before);
}

/// Forces first, while every copy is near its owner.
void ParallelBodyExchange::relocate(rigid::BodySet& bodies) {
  wrap_positions(bodies);
  if (!distribution_) return;
  distribution_->sum_forces(bodies);
  distribution_->synchronise(bodies, Distribution::Owners::anywhere);
}

void ParallelBodyExchange::cut_anew(rigid::BodySet& bodies) {
  wrap_positions(bodies);
  if (!distribution_) return;
  const ExchangeCounters before = counters();
  distribution_ = std::make_shared<Distribution>(comm_, rank_, domain_, world_, rim_);
  distribution_->counters = before;
  distribution_->deal_out(bodies);
}

void ParallelBodyExchange::take_out(rigid::BodySet& bodies, std::span<const std::size_t> rows) {
  for (std::size_t k = rows.size(); k-- > 0;) {
    if (distribution_) distribution_->forget(bodies.id[rows[k]]);
    --(rows[k] < bodies.owned ? bodies.owned : bodies.copies);
    bodies.erase(rows[k]);
  }
  bodies.reindex();
  if (distribution_) distribution_->tie(bodies);
}

double ParallelBodyExchange::reach() const {
  return distribution_ ? distribution_->reach : 0;
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

std::vector<int> ParallelBodyExchange::holders(const rigid::BodySet& bodies, std::size_t row) const {
  std::vector<int> ranks{0};
  if (distribution_) distribution_->find_holders(bodies, row, ranks);
  return ranks;
}

void ParallelBodyExchange::exchange_contacts(rigid::BodySet& bodies, std::vector<rigid::Contact>& contacts) {
  if (!distribution_) return;
  distribution_->exchange_contacts(bodies, contacts);
  cluster_.begin(rank_, distribution_->partners(), ranks_);
}

void ParallelBodyExchange::share(rigid::BodySet&, std::span<double> rows, int width,
                                 std::span<const rigid::RankCluster::Word> said,
                                 std::span<rigid::RankCluster::Word> heard, bool changed) {
  if (distribution_) distribution_->share(rows, width, said, heard, changed);
}

void ParallelBodyExchange::sum_to_owners(const rigid::BodySet& bodies, std::span<std::int64_t> rows,
                                         int width) const {
  if (distribution_) distribution_->sum_to_owners(bodies, rows, width);
}

void ParallelBodyExchange::share_with_copies(const rigid::BodySet& bodies, std::span<double> rows,
                                             int width) const {
  if (distribution_) distribution_->share_with_copies(bodies, rows, width);
}

const ExchangeCounters& ParallelBodyExchange::counters() const {
  if (distribution_) {
    counters_ = distribution_->counters;
    counters_.messages += distribution_->messages.messages_sent();
    counters_.bytes += distribution_->messages.bytes_sent();
  }
  return counters_;
}

}  // namespace silt::coupler

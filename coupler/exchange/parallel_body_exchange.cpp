#include "coupler/exchange/parallel_body_exchange.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>

#include "coupler/exchange/check_exchange.hpp"
#include "parallel/collectives.hpp"
#include "parallel/communicator.hpp"

namespace silt::coupler {

using rigid::BodyId;

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

template <class T>
std::span<T> row_of(std::span<T> rows, std::size_t row, int width) {
  return rows.subspan(row * width, width);
}

/// Makes a body set of the owned bodies, sorted by id, and the former walls.
rigid::BodySet rebuilt(std::vector<OwnedBody>& own, const rigid::BodySet& before) {
  std::sort(own.begin(), own.end(),
            [](const OwnedBody& a, const OwnedBody& b) { return a.record.id < b.record.id; });
  rigid::BodySet bodies;
  bodies.resize(own.size() + before.walls);
  bodies.owned = own.size();
  bodies.walls = before.walls;
  bodies.locked_of_kind = before.locked_of_kind;
  std::size_t row = 0;
  for (OwnedBody& body : own) {
    bodies.assign(row, body.record);
    bodies.force[row] = body.force;
    bodies.torque[row] = body.torque;
    bodies.stored_impulses[row++] = std::move(body.impulses);
  }
  for (std::size_t wall = before.first_wall(); wall < before.size(); ++wall)
    bodies.assign(row++, before.record(wall));
  bodies.reindex();
  return bodies;
}

/// Calls each(member) for every member of a stored impulse.
template <class AnyImpulse, class Each>
void for_impulse_members(AnyImpulse& s, Each&& each) {
  each(s.partner), each(s.image), each(s.feature);
  for (int d = 0; d < 3; ++d) each(s.impulse[d]);
}

void put_impulses(parallel::Bytes& to, const std::vector<rigid::StoredImpulse>& impulses) {
  parallel::put(to, static_cast<std::uint64_t>(impulses.size()));
  for (const rigid::StoredImpulse& s : impulses)
    for_impulse_members(s, [&](const auto& member) { parallel::put(to, member); });
}

std::vector<rigid::StoredImpulse> read_impulses(parallel::ByteReader& from) {
  std::vector<rigid::StoredImpulse> impulses(from.read<std::uint64_t>());
  for (rigid::StoredImpulse& s : impulses)
    for_impulse_members(s, [&](auto& member) { member = from.read<std::decay_t<decltype(member)>>(); });
  return impulses;
}

}  // namespace

ParallelBodyExchange::ParallelBodyExchange(MPI_Comm comm, const lbm::Domain& domain,
                                           const rigid::World& world, double rim)
    : rigid::BodyExchange(extent_of(domain)),
      comm_(comm),
      rank_(parallel::rank_of(comm)),
      ranks_(parallel::ranks_of(comm)),
      neighbourhood_(domain, world, rim, rank_),
      messages_(comm) {}

void ParallelBodyExchange::synchronise(rigid::BodySet& bodies) {
  wrap_positions(bodies);
  if (ranks_ == 1) return;
  std::optional<ExpectedBodies> before;
  if (asserts) before.emplace(bodies);
  synchronise(bodies, Owners::next_to_each_other);
  if (asserts) check_exchange(*this, bodies, *before);
}

void ParallelBodyExchange::relocate(rigid::BodySet& bodies) {
  wrap_positions(bodies);
  if (ranks_ == 1) return;
  synchronise(bodies, Owners::anywhere);
}

void ParallelBodyExchange::repartition(rigid::BodySet& bodies) {
  wrap_positions(bodies);
  if (ranks_ == 1) return;
  neighbourhood_ = neighbourhood_.renewed();
  redistribute(bodies);
}

/// Sends owned bodies, which may be on any rank, to their owners by the cuts, and makes all copies anew.
void ParallelBodyExchange::redistribute(rigid::BodySet& bodies) {
  std::vector<OwnedBody> own;
  for (std::size_t row = 0; row < bodies.owned; ++row)
    own.push_back(
        {bodies.record(row), bodies.force[row], bodies.torque[row], std::move(bodies.stored_impulses[row])});
  own = sent_to_owners(messages_, neighbourhood_.holders(), std::move(own));
  bodies = rebuilt(own, bodies);
  held_by_.clear();
  owner_of_.clear();
  velocity_messages_.clear();
  synchronise(bodies, Owners::next_to_each_other);
}

void ParallelBodyExchange::remove_bodies(rigid::BodySet& bodies, std::span<const std::size_t> rows) {
  for (std::size_t k = rows.size(); k-- > 0;) {
    held_by_.erase(bodies.id[rows[k]]);
    owner_of_.erase(bodies.id[rows[k]]);
    --(rows[k] < bodies.owned ? bodies.owned : bodies.copies);
    bodies.erase(rows[k]);
  }
  bodies.reindex();
  tie(bodies);
}

double ParallelBodyExchange::reach() const {
  return ranks_ > 1 ? neighbourhood_.reach() : 0;
}

int ParallelBodyExchange::rank_at(const rigid::Vec3& x_W) const {
  return ranks_ > 1 ? neighbourhood_.rank_at(x_W) : 0;
}

bool ParallelBodyExchange::owns_contact_at(const rigid::Vec3& x_W) const {
  return rank_at(x_W) == rank_;
}

int ParallelBodyExchange::owner_of(const rigid::BodySet& bodies, std::size_t row) const {
  return row < bodies.owned || ranks_ == 1 ? rank_ : owner(bodies.id[row]);
}

int ParallelBodyExchange::owner(BodyId id) const {
  const auto found = owner_of_.find(id);
  if (found == owner_of_.end())
    throw std::logic_error("body " + std::to_string(id) + " has no known owner here");
  return found->second;
}

std::vector<int> ParallelBodyExchange::holders(int shape, const rigid::Pose& pose) const {
  std::vector<int> ranks{0};
  if (ranks_ > 1) neighbourhood_.find_holders(shape, pose, {}, ranks);
  return ranks;
}

std::vector<int> ParallelBodyExchange::holders(const rigid::BodySet& bodies, std::size_t row) const {
  std::vector<int> ranks{0};
  if (ranks_ > 1) neighbourhood_.find_holders(bodies, row, ranks);
  return ranks;
}

ExchangeCounters ParallelBodyExchange::counters() const {
  return {counters_.migrations, counters_.copies_made, messages_.messages_sent(), messages_.bytes_sent()};
}

std::vector<int> ParallelBodyExchange::ranks_with(std::vector<BodyId> Tie::*have) const {
  std::vector<int> ranks;
  for (const Tie& t : ties_)
    if (!(t.*have).empty()) ranks.push_back(t.rank);
  return ranks;
}

const ParallelBodyExchange::Tie& ParallelBodyExchange::tie_with(int rank) const {
  return *std::ranges::find_if(ties_, [&](const Tie& t) { return t.rank == rank; });
}

void ParallelBodyExchange::tie(const rigid::BodySet& bodies) {
  ties_.clear();
  const auto with = [&](int other) -> Tie& {
    const auto at =
        std::lower_bound(ties_.begin(), ties_.end(), other, [](const Tie& t, int r) { return t.rank < r; });
    return at != ties_.end() && at->rank == other ? *at : *ties_.insert(at, {other, {}, {}});
  };
  std::vector<BodyId> held;
  for (const auto& [id, holding] : held_by_) held.push_back(id);
  std::sort(held.begin(), held.end());
  for (const BodyId id : held)
    for (const int holder : held_by_.find(id)->second.ranks) with(holder).sent.push_back(id);
  for (std::size_t row = bodies.owned; row < bodies.owned + bodies.copies; ++row)
    with(owner(bodies.id[row])).received.push_back(bodies.id[row]);
}

void ParallelBodyExchange::sum_to_owners(const rigid::BodySet& bodies, std::span<std::int64_t> rows,
                                         int width) {
  if (ranks_ == 1) return;
  for (const Tie& t : ties_)
    for (const BodyId id : t.received) {
      const std::span<std::int64_t> values = row_of(rows, bodies.row_of(id), width);
      parallel::put(messages_.to(t.rank), std::span<const std::int64_t>(values));
      std::fill(values.begin(), values.end(), 0);
    }
  messages_.exchange_with(ranks_with(&Tie::sent));
  std::vector<std::int64_t> values(width);
  for (const parallel::Messages::Message& m : messages_.received()) {
    parallel::ByteReader reader(m.bytes);
    for (const BodyId id : tie_with(m.rank).sent) {
      reader.read(std::span(values));
      const std::span<std::int64_t> sums = row_of(rows, bodies.row_of(id), width);
      for (int k = 0; k < width; ++k) sums[k] += values[k];
    }
  }
}

void ParallelBodyExchange::share_with_copies(const rigid::BodySet& bodies, std::span<double> rows,
                                             int width) {
  if (ranks_ == 1) return;
  std::vector<double> none(width, 0.0);  // for a body removed from the simulation since
  const auto values_of = [&](BodyId id) {
    const std::size_t row = bodies.row_of(id);
    return row < bodies.size() ? row_of(rows, row, width) : std::span(none);
  };
  for (const Tie& t : ties_)
    for (const BodyId id : t.sent)
      parallel::put(messages_.to(t.rank), std::span<const double>(values_of(id)));
  messages_.exchange_with(ranks_with(&Tie::received));
  for (const parallel::Messages::Message& m : messages_.received()) {
    parallel::ByteReader reader(m.bytes);
    for (const BodyId id : tie_with(m.rank).received) reader.read(values_of(id));
  }
}

void put_body(parallel::Bytes& to, const OwnedBody& body) {
  parallel::put(to, body.record);
  parallel::put(to, body.force.q);
  parallel::put(to, body.torque.q);
  put_impulses(to, body.impulses);
}

OwnedBody read_body(parallel::ByteReader& from) {
  OwnedBody body{from.read<rigid::BodyRecord>()};
  body.force.q = from.read<decltype(body.force.q)>();
  body.torque.q = from.read<decltype(body.torque.q)>();
  body.impulses = read_impulses(from);
  return body;
}

std::vector<OwnedBody> sent_to_owners(parallel::Messages& messages, const Holders& holders,
                                      std::vector<OwnedBody> bodies) {
  const int rank = parallel::rank_of(messages.comm());
  std::vector<OwnedBody> own;
  for (OwnedBody& body : bodies) {
    const int owner = holders.rank_at(Eigen::Map<const rigid::Vec3>{body.record.position});
    if (owner == rank)
      own.push_back(std::move(body));
    else
      put_body(messages.to(owner), body);
  }
  messages.exchange_sparse();
  for (const parallel::Messages::Message& m : messages.received())
    for (parallel::ByteReader reader(m.bytes); !reader.done();) own.push_back(read_body(reader));
  return own;
}

void distribute_to_owners(parallel::Messages& messages, const Holders& holders, const SavedBodies& saved,
                          rigid::BodySet& bodies, std::size_t at_once) {
  const std::size_t n = saved.records.size(), most = parallel::most_over_ranks(messages.comm(), n);
  for (std::size_t first = 0; first < most; first += at_once) {
    std::vector<OwnedBody> round;
    for (std::size_t i = first; i < std::min(first + at_once, n); ++i)
      round.push_back({.record = saved.records[i], .impulses = saved.impulses[i]});
    for (OwnedBody& body : sent_to_owners(messages, holders, std::move(round))) {
      bodies.add(body.record);
      bodies.stored_impulses[bodies.owned - 1] = std::move(body.impulses);
    }
  }
  bodies.reindex();
}

}  // namespace silt::coupler

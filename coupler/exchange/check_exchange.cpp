#include "coupler/exchange/check_exchange.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <tuple>

#include "coupler/exchange/coupling_state.hpp"
#include "parallel/collectives.hpp"
#include "parallel/together.hpp"

namespace silt::coupler {

namespace {

class Hash {
 public:
  void add(std::uint64_t x) {  // splitmix64
    state_ += 0x9E3779B97F4A7C15u + x;
    state_ = (state_ ^ state_ >> 30) * 0xBF58476D1CE4E5B9u;
    state_ = (state_ ^ state_ >> 27) * 0x94D049BB133111EBu;
    state_ ^= state_ >> 31;
  }
  void add(double x) { add(std::bit_cast<std::uint64_t>(x)); }
  void add(std::int32_t x) { add(static_cast<std::uint64_t>(static_cast<std::uint32_t>(x))); }
  template <class T, std::size_t n>
  void add(const T (&values)[n]) {
    for (const T& x : values) add(x);
  }
  void add(const rigid::HolderState& state, const rigid::HolderColumn& c) {
    for (const double x : state[c]) add(x);
    for (const std::int64_t x : state.whole(c)) add(static_cast<std::uint64_t>(x));
  }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0;
};

std::uint64_t hash_of(const std::vector<rigid::StoredImpulse>& impulses) {
  Hash h;
  for (const rigid::StoredImpulse& s : impulses) {
    h.add(s.partner);
    h.add(s.feature);
    for (const std::int8_t periods : {s.image.x, s.image.y, s.image.z}) h.add(std::int32_t{periods});
    for (int d = 0; d < 3; ++d) h.add(s.impulse[d]);
  }
  return h.value();
}

/// What a copy shares with its owner's body: all but what the owner keeps to itself.
void add_shared(Hash& h, const rigid::BodyRecord& r) {
  h.add(r.id);
  h.add(r.shape);
  h.add(r.material);
  h.add(r.kind);
  h.add(static_cast<std::int32_t>(r.motion));
  h.add(static_cast<std::int32_t>(r.wakefulness));
  h.add(r.mass);
  h.add(r.weight_in_fluid);
  h.add(r.inertia_B);
  h.add(r.position);
  h.add(r.orientation);
  h.add(r.image);
  h.add(r.velocity);
  h.add(r.angular_velocity);
  h.add(r.angular_momentum);
  for (const rigid::HolderColumn& c : column::copied) h.add(r.holder_state, c);
}

std::uint64_t shared_hash(const rigid::BodyRecord& r) {
  Hash h;
  add_shared(h, r);
  return h.value();
}

/// What is wrong with a body; the least id of all ranks is told.
struct Finding {
  static constexpr rigid::BodyId nobody = std::numeric_limits<rigid::BodyId>::max();
  rigid::BodyId id = nobody;
  std::string text;

  void note(rigid::BodyId body, const std::string& what) {
    if (body < id) *this = {body, "body " + std::to_string(body) + ' ' + what};
  }
};

/// Throws the same on every rank, if any of them found something.
void throw_first(MPI_Comm comm, Finding found, std::int64_t step) {
  const rigid::BodyId least = parallel::least_over_ranks(comm, found.id);
  if (least == Finding::nobody) return;
  throw std::logic_error(
      (step < 0 ? "" : "step " + std::to_string(step) + ": ") +
      parallel::text_of_first(comm, found.id == least ? found.text : "") +
      "; the exchange of bodies between ranks is at fault: please report this with its case");
}

/// The ids that all ranks own, in the order of ranks, and where those of each rank begin.
struct AllIds {
  std::vector<std::size_t> first;
  std::vector<rigid::BodyId> ids;

  AllIds(MPI_Comm comm, const rigid::BodySet& bodies)
      : ids(parallel::gathered(comm, std::span<const rigid::BodyId>(bodies.id.data(), bodies.owned),
                               parallel::Told::everybody, &first)) {}
  int owner(std::size_t place) const {
    return static_cast<int>(std::upper_bound(first.begin(), first.end(), place) - first.begin()) - 1;
  }
};

/// Says which body has two owners or none. Of one that left no trace only a gap tells, where ids count up
/// without one.
Finding lost_or_doubled(const ParallelBodyExchange& exchange, const rigid::BodySet& bodies,
                        std::uint64_t expected) {
  const AllIds all(exchange.comm(), bodies);
  std::vector<std::size_t> order(all.ids.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](auto i, auto j) { return std::tie(all.ids[i], i) < std::tie(all.ids[j], j); });
  const bool counting = !order.empty() && all.ids[order.back()] - all.ids[order.front()] < expected;
  Finding found;
  for (std::size_t k = 1; k < order.size(); ++k) {
    const rigid::BodyId before = all.ids[order[k - 1]], id = all.ids[order[k]];
    if (id == before)
      found.note(id, "is owned by ranks " + std::to_string(all.owner(order[k - 1])) + " and " +
                         std::to_string(all.owner(order[k])));
    if (id > before + 1 && counting) found.note(before + 1, "is owned by no rank");
  }
  for (std::size_t row = bodies.owned; row < bodies.owned + bodies.copies; ++row) {
    const rigid::BodyId id = bodies.id[row];
    const auto at = std::lower_bound(order.begin(), order.end(), id,
                                     [&](auto i, auto wanted) { return all.ids[i] < wanted; });
    if (at == order.end() || all.ids[*at] != id)
      found.note(id, "is owned by no rank, but rank " + std::to_string(exchange.rank()) +
                         " holds a copy and takes rank " + std::to_string(exchange.owner_of(bodies, row)) +
                         " for its owner");
  }
  if (found.id == Finding::nobody)
    found = {Finding::nobody - 1,
             std::to_string(all.ids.size()) + " bodies have an owner, not " + std::to_string(expected)};
  return found;
}

/// Order, look-up and place of the bodies of this rank.
Finding misplaced(const ParallelBodyExchange& exchange, const rigid::BodySet& bodies) {
  const std::string here = " on rank " + std::to_string(exchange.rank());
  Finding found;
  for (std::size_t row = 0; row < bodies.size(); ++row) {
    const rigid::BodyId id = bodies.id[row];
    if (bodies.row_of(id) != row) found.note(id, "is twice" + here + ", or not where the look-up says");
    if (row >= bodies.owned + bodies.copies) continue;
    if (row > 0 && row != bodies.owned && bodies.id[row - 1] >= id) found.note(id, "is out of order" + here);
    const int centre = exchange.rank_at(bodies.position[row]);
    if ((centre == exchange.rank()) != (row < bodies.owned))
      found.note(id, (row < bodies.owned ? "is owned" : "is a copy") + here + ", but rank " +
                         std::to_string(centre) + " holds its centre");
  }
  return found;
}

Finding copies_that_differ(const ParallelBodyExchange& exchange, const rigid::BodySet& bodies) {
  std::vector<double> hashes(bodies.size());
  for (std::size_t row = 0; row < bodies.owned; ++row)
    hashes[row] = std::bit_cast<double>(shared_hash(bodies.record(row)));
  exchange.share_with_copies(bodies, hashes, 1);
  Finding found;
  for (std::size_t row = bodies.owned; row < bodies.owned + bodies.copies; ++row)
    if (std::bit_cast<std::uint64_t>(hashes[row]) != shared_hash(bodies.record(row)))
      found.note(bodies.id[row], "differs on rank " + std::to_string(exchange.rank()) +
                                     ", which has a copy, from rank " +
                                     std::to_string(exchange.owner_of(bodies, row)) + ", which owns it");
  return found;
}

}  // namespace

std::uint64_t hash_of(const rigid::BodyRecord& r) {
  Hash h;
  add_shared(h, r);
  for (const rigid::HolderColumn& c : column::saved) h.add(r.holder_state, c);
  return h.value();
}

namespace {

std::uint64_t hash_of_id(rigid::BodyId id) {
  Hash h;
  h.add(id);
  return h.value();
}

OwnedBodies owned_here(const rigid::BodySet& bodies) {
  OwnedBodies here{bodies.owned, 0};
  for (std::size_t row = 0; row < bodies.owned; ++row) here.ids += hash_of_id(bodies.id[row]);
  return here;
}

}  // namespace

ExpectedBodies::ExpectedBodies(const rigid::BodySet& bodies) : share_(owned_here(bodies)) {}

void ExpectedBodies::come(rigid::BodyId first, std::uint64_t n, int rank, int ranks) {
  for (std::uint64_t k = rank; k < n; k += ranks) {
    ++share_.count;
    share_.ids += hash_of_id(first + k);
  }
}

void ExpectedBodies::leave(rigid::BodyId id) {
  --share_.count;
  share_.ids -= hash_of_id(id);
}

OwnedBodies ExpectedBodies::excess(const rigid::BodySet& bodies) const {
  const OwnedBodies here = owned_here(bodies);
  return {here.count - share_.count, here.ids - share_.ids};
}

std::uint64_t ExpectedBodies::count(MPI_Comm comm) const {
  return parallel::sum_over_ranks(comm, share_.count);
}

OwnedBodies count_owned(MPI_Comm comm, const rigid::BodySet& bodies) {
  return parallel::sum_over_ranks(comm, owned_here(bodies));
}

std::uint64_t records_hash(MPI_Comm comm, const rigid::BodySet& bodies, bool stored_impulses) {
  std::uint64_t mine = 0;
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    mine += hash_of(bodies.record(row));
    if (stored_impulses) mine += hash_of(bodies.stored_impulses[row]) ^ bodies.id[row];
  }
  return parallel::sum_over_ranks(comm, mine);
}

void check_exchange(const ParallelBodyExchange& exchange, const rigid::BodySet& bodies,
                    const std::optional<OwnedBodies>& expected, std::int64_t step) {
  if (expected && count_owned(exchange.comm(), bodies) != *expected)
    throw_first(exchange.comm(), lost_or_doubled(exchange, bodies, expected->count), step);
  throw_first(exchange.comm(), misplaced(exchange, bodies), step);
  throw_first(exchange.comm(), copies_that_differ(exchange, bodies), step);
}

void CheckUnderWay::start(const ParallelBodyExchange& exchange, const rigid::BodySet& bodies,
                          const ExpectedBodies& expected, std::int64_t step) {
  Finding found = misplaced(exchange, bodies);
  const Finding differs = copies_that_differ(exchange, bodies);
  if (differs.id < found.id) found = differs;
  bad_ = found.id, text_ = found.text, step_ = step;
  sums_.start(exchange.comm(), {expected.excess(bodies), found.id != Finding::nobody});
}

void CheckUnderWay::finish(const ParallelBodyExchange& exchange, const rigid::BodySet& bodies,
                           const ExpectedBodies& expected) {
  if (!sums_.under_way()) return;
  const Sums& all = sums_.finish();
  if (all.excess != OwnedBodies{})
    throw_first(exchange.comm(), lost_or_doubled(exchange, bodies, expected.count(exchange.comm())), step_);
  if (all.findings > 0) throw_first(exchange.comm(), {bad_, text_}, step_);
}

}  // namespace silt::coupler

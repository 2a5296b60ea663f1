#include "coupler/exchange/check_exchange.hpp"

#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <tuple>

#include "coupler/exchange/coupling_state.hpp"
#include "parallel/collectives.hpp"
#include "parallel/together.hpp"

namespace silt::coupler {
namespace {

std::uint64_t hash_of(const parallel::Bytes& bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

std::uint64_t hash_of_id(rigid::BodyId id) {
  return XXH3_64bits(&id, sizeof id);
}

/// Returns the bytes in which a copy must agree with its owner's body: all but the owner's private state.
parallel::Bytes shared_bytes(const rigid::BodyRecord& r) {
  parallel::Bytes bytes;
  bytes.reserve(sizeof r);
  visit_columns(r, [&](const rigid::BodyColumn&, auto numbers) { parallel::put(bytes, numbers); });
  visit_columns(coupling_of(r.attached_state), [&](const CouplingColumn& c, auto numbers) {
    if (c.copied) parallel::put(bytes, numbers);
  });
  return bytes;
}

/// An error found for a body; the one of the least id over all ranks is reported.
struct Finding {
  static constexpr rigid::BodyId nobody = std::numeric_limits<rigid::BodyId>::max();
  rigid::BodyId id = nobody;
  std::string text;

  void note(rigid::BodyId body, const std::string& what) {
    if (body < id) *this = {body, "body " + std::to_string(body) + ' ' + what};
  }
};

/// Throws the same error on every rank if any rank found one.
void throw_first(MPI_Comm comm, Finding found, std::int64_t step) {
  const rigid::BodyId least = parallel::least_over_ranks(comm, found.id);
  if (least == Finding::nobody) return;
  throw std::logic_error(
      (step < 0 ? "" : "step " + std::to_string(step) + ": ") +
      parallel::text_of_first(comm, found.id == least ? found.text : "") +
      "; the exchange of bodies between ranks is at fault: please report this with its case");
}

/// The ids owned by all ranks, in rank order, and where those of each rank begin.
struct AllIds {
  std::vector<std::size_t> first;
  std::vector<rigid::BodyId> ids;

  AllIds(MPI_Comm comm, const rigid::BodySet& bodies)
      : ids(parallel::gathered(comm, std::span<const rigid::BodyId>(bodies.id.data(), bodies.owned),
                               parallel::GatherTo::all_ranks, &first)) {}
  int owner(std::size_t place) const {
    return static_cast<int>(std::upper_bound(first.begin(), first.end(), place) - first.begin()) - 1;
  }
};

/// Finds a body with two owners or none. One that is nowhere shows as a gap in consecutive ids.
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

/// Checks the order, look-up and position of this rank's bodies.
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

Finding copies_that_differ(ParallelBodyExchange& exchange, const rigid::BodySet& bodies) {
  std::vector<double> hashes(bodies.size());
  for (std::size_t row = 0; row < bodies.owned; ++row)
    hashes[row] = std::bit_cast<double>(hash_of(shared_bytes(bodies.record(row))));
  exchange.share_with_copies(bodies, hashes, 1);
  Finding found;
  for (std::size_t row = bodies.owned; row < bodies.owned + bodies.copies; ++row)
    if (std::bit_cast<std::uint64_t>(hashes[row]) != hash_of(shared_bytes(bodies.record(row))))
      found.note(bodies.id[row], "differs on rank " + std::to_string(exchange.rank()) +
                                     ", which has a copy, from rank " +
                                     std::to_string(exchange.owner_of(bodies, row)) + ", which owns it");
  return found;
}

OwnedBodies owned_here(const rigid::BodySet& bodies) {
  OwnedBodies here{bodies.owned, 0};
  for (std::size_t row = 0; row < bodies.owned; ++row) here.ids += hash_of_id(bodies.id[row]);
  return here;
}

}  // namespace

ExpectedBodies::ExpectedBodies(const rigid::BodySet& bodies) : share_(owned_here(bodies)) {}

void ExpectedBodies::add(rigid::BodyId first, std::uint64_t n, int rank, int ranks) {
  for (std::uint64_t k = rank; k < n; k += ranks) {
    ++share_.count;
    share_.ids += hash_of_id(first + k);
  }
}

void ExpectedBodies::remove(rigid::BodyId id) {
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

void PendingCheck::start(ParallelBodyExchange& exchange, const rigid::BodySet& bodies,
                         const ExpectedBodies& expected, std::int64_t step) {
  Finding found = misplaced(exchange, bodies);
  const Finding differs = copies_that_differ(exchange, bodies);
  if (differs.id < found.id) found = differs;
  bad_ = found.id, text_ = found.text, step_ = step;
  sums_.start(exchange.comm(), {expected.excess(bodies), found.id != Finding::nobody});
}

void PendingCheck::finish(const ParallelBodyExchange& exchange, const rigid::BodySet& bodies,
                          const ExpectedBodies& expected) {
  if (!sums_.under_way()) return;
  const Sums& all = sums_.finish();
  if (all.excess != OwnedBodies{})
    throw_first(exchange.comm(), lost_or_doubled(exchange, bodies, expected.count(exchange.comm())), step_);
  if (all.findings > 0) throw_first(exchange.comm(), {bad_, text_}, step_);
}

void check_exchange(ParallelBodyExchange& exchange, const rigid::BodySet& bodies,
                    const ExpectedBodies& expected) {
  PendingCheck check;
  check.start(exchange, bodies, expected, -1);
  check.finish(exchange, bodies, expected);
}

}  // namespace silt::coupler

// Line 23 of Algorithm 1: afterwards every copy equals its owner's state, and bodies belong to their centre's
// rank.
//
// A message has items in the order of the sender's rows:
//   update    to a rank that keeps its copy: the state
//   copy      to a rank without a copy: the record
//   handover  to the new owner: the record, forces, stored impulses, and the ranks with a copy
// A copy that is not updated is deleted. A rank that hands a body over keeps a copy until the next
// synchronisation, whether it overlaps or not.
#include <algorithm>
#include <string>

#include "coupler/exchange/parallel_body_exchange.hpp"

namespace silt::coupler {

using rigid::BodyId;
using rigid::BodyRecord;
using rigid::BodySet;

namespace {

enum class BodyItem : std::uint64_t { update, copy, handover };

/// The part of a body's record that changes in every step.
struct State {
  BodyId id;
  rigid::Kinematics kinematics;
  std::int32_t image[3];
  std::uint32_t owner : 30, motion : 2;
};

State state_of(const BodyRecord& r, int owner) {
  return {r.id, r, {r.image[0], r.image[1], r.image[2]}, std::uint32_t(owner), std::uint32_t(r.motion) & 3};
}

void assign(BodySet& bodies, std::size_t row, const State& s) {
  bodies.set_kinematics(row, s.kinematics);
  bodies.image[row] = std::to_array(s.image);
  bodies.motion[row] = rigid::Motion(s.motion);
}

/// Inserts into a section of rows in the order of ids.
std::size_t insert_sorted(BodySet& bodies, std::size_t first, std::size_t& count, const BodyRecord& record) {
  const auto begin = bodies.id.begin() + first;
  const std::size_t row = std::lower_bound(begin, begin + count, record.id) - bodies.id.begin();
  bodies.insert(row, record);
  ++count;
  return row;
}

}  // namespace

struct ParallelBodyExchange::Arrivals {
  /// A received body.
  struct Traveller {
    OwnedBody body;  // only the record, if it is a copy
    int owner;       // after this synchronisation
    std::vector<int> holders;
  };
  std::vector<std::uint8_t> updated;  // one per copy
  std::vector<Traveller> copies, own;
};

void ParallelBodyExchange::synchronise(BodySet& bodies, Owners owners) {
  bool rows_changed = remove_visitors(bodies);
  std::vector<std::size_t> departures;  // owned rows that are handed over
  announce(bodies, owners, departures);
  if (owners == Owners::anywhere)
    messages_.exchange_sparse();
  else
    messages_.exchange_with(neighbourhood_.around());
  Arrivals arrivals;
  arrivals.updated.assign(bodies.copies, 0);
  read(bodies, arrivals);
  rows_changed = update_rows(bodies, arrivals, departures) || rows_changed;
  if (rows_changed) bodies.reindex();
  tie(bodies);
}

/// Prepares messages to all ranks around, which expect one, possibly empty.
void ParallelBodyExchange::expect_all_around() {
  for (const int other : neighbourhood_.around()) messages_.to(other);
}

bool ParallelBodyExchange::remove_visitors(BodySet& bodies) {
  velocity_messages_.clear();
  if (bodies.visitors == 0) return false;
  for (; bodies.visitors > 0; --bodies.visitors) {
    const std::size_t last = bodies.first_wall() - 1;
    owner_of_.erase(bodies.id[last]);
    bodies.erase(last);
  }
  return true;
}

void ParallelBodyExchange::announce(BodySet& bodies, Owners owners, std::vector<std::size_t>& departures) {
  std::vector<int> ranks;
  ++round_;
  if (owners != Owners::anywhere) expect_all_around();
  for (std::size_t row = 0; row < bodies.owned; ++row)
    if (announce_body(bodies, row, owners, ranks)) departures.push_back(row);
  std::erase_if(held_by_, [&](const auto& held) { return held.second.round != round_; });
}

void ParallelBodyExchange::require_around(BodyId id, int to) const {
  const std::vector<int>& around = neighbourhood_.around();
  if (std::binary_search(around.begin(), around.end(), to)) return;
  throw std::runtime_error("body " + std::to_string(id) + " has come from rank " + std::to_string(rank_) +
                           " to rank " + std::to_string(to) + " at once, further than " +
                           std::to_string(neighbourhood_.reach()) +
                           " cells: use a shorter time step, or fewer ranks");
}

/// Returns whether the body is handed over. ranks: scratch.
bool ParallelBodyExchange::announce_body(const BodySet& bodies, std::size_t row, Owners owners,
                                         std::vector<int>& ranks) {
  const BodyId id = bodies.id[row];
  neighbourhood_.find_holders(bodies, row, ranks);
  if (ranks.size() == 1 && ranks[0] == rank_) return false;  // as most
  const auto known = held_by_.find(id);
  const int owner = rank_at(bodies.position[row]);
  include(ranks, rank_);
  const BodyRecord record = bodies.record(row);
  for (const int to : ranks) {
    if (to == rank_) continue;
    if (owners != Owners::anywhere) require_around(id, to);
    parallel::Bytes& message = messages_.to(to);
    if (to == owner) {
      parallel::put(message, BodyItem::handover);
      put_body(message, {record, bodies.force[row], bodies.torque[row], bodies.stored_impulses[row]});
      parallel::put(message, static_cast<std::uint64_t>(ranks.size() - 1));
      for (const int other : ranks)
        if (other != owner) parallel::put(message, other);
    } else if (known != held_by_.end() && known->second.has(to)) {
      parallel::put(message, BodyItem::update);
      parallel::put(message, state_of(record, owner));
    } else {
      parallel::put(message, BodyItem::copy);
      parallel::put(message, record);
      parallel::put(message, owner);
    }
  }
  if (owner != rank_) {
    if (known != held_by_.end()) held_by_.erase(known);
    return true;
  }
  auto& [others, round] = held_by_[id];
  round = round_;
  others.clear();
  std::copy_if(ranks.begin(), ranks.end(), std::back_inserter(others), [&](int r) { return r != rank_; });
  return false;
}

void ParallelBodyExchange::read(BodySet& bodies, Arrivals& arrivals) {
  for (const parallel::Messages::Message& m : messages_.received())
    for (parallel::ByteReader reader(m.bytes); !reader.done();) {
      const auto item = reader.read<BodyItem>();
      if (item == BodyItem::update) {
        const auto state = reader.read<State>();
        const std::size_t row = bodies.row_of(state.id);
        if (row < bodies.owned || row >= bodies.owned + bodies.copies)
          throw std::logic_error("an update came for body " + std::to_string(state.id) +
                                 ", of which there is no copy");
        assign(bodies, row, state);
        owner_of_[state.id] = int(state.owner);
        arrivals.updated[row - bodies.owned] = 1;
      } else if (item == BodyItem::copy) {
        Arrivals::Traveller& t = arrivals.copies.emplace_back();
        t.body.record = reader.read<BodyRecord>();
        t.owner = reader.read<int>();
      } else {
        Arrivals::Traveller& t = arrivals.own.emplace_back();
        t.body = read_body(reader);
        t.holders.resize(reader.read<std::uint64_t>());
        reader.read(std::span(t.holders));
      }
    }
}

/// Deletes copies without an update, makes copies of bodies handed over, inserts arrivals. Returns whether
/// rows changed.
bool ParallelBodyExchange::update_rows(BodySet& bodies, Arrivals& arrivals,
                                       const std::vector<std::size_t>& departures) {
  bool changed = !departures.empty() || !arrivals.own.empty() || !arrivals.copies.empty();
  for (std::size_t k = arrivals.updated.size(); k-- > 0;) {
    if (arrivals.updated[k]) continue;
    owner_of_.erase(bodies.id[bodies.owned + k]);
    bodies.erase(bodies.owned + k);
    --bodies.copies;
    changed = true;
  }
  counters_.migrations += departures.size();
  for (std::size_t k = departures.size(); k-- > 0;) {
    const BodyRecord record = bodies.record(departures[k]);
    bodies.erase(departures[k]);
    --bodies.owned;
    insert_sorted(bodies, bodies.owned, bodies.copies, record);
    owner_of_[record.id] = rank_at(Eigen::Map<const rigid::Vec3>{record.position});
  }
  for (Arrivals::Traveller& t : arrivals.own) {
    const std::size_t row = insert_sorted(bodies, 0, bodies.owned, t.body.record);
    bodies.force[row] = t.body.force;
    bodies.torque[row] = t.body.torque;
    bodies.stored_impulses[row] = std::move(t.body.impulses);
    held_by_[bodies.id[row]] = {std::move(t.holders), round_};
  }
  for (const Arrivals::Traveller& t : arrivals.copies) {
    insert_sorted(bodies, bodies.owned, bodies.copies, t.body.record);
    owner_of_[t.body.record.id] = t.owner;
    ++counters_.copies_made;
  }
  return changed;
}

}  // namespace silt::coupler

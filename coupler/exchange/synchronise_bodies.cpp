// Lines 6 and 23 of Algorithm 1: after them every copy equals its owner's state, and every body is where its
// centre is.
//
// A message holds, one after the other, in the order of the sender's rows:
//   update    a rank that had a copy and keeps it: the state
//   copy      a rank that had none: everything
//   handover  the new owner: everything, forces, stored impulses, and which ranks hold a copy
//   force     what acts on a copy: to its owner
// A copy that nobody updates is dropped. The rank that hands a body over keeps a copy until the next time,
// whether it overlaps or not, so that a force on its way to the old owner is not lost.
#include <algorithm>
#include <string>

#include "coupler/exchange/distribution.hpp"
#include "coupler/exchange/impulse_bytes.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

using rigid::BodyId;
using rigid::BodyRecord;
using rigid::BodySet;

namespace {

enum class BodyItem : std::uint64_t { update, copy, handover, force };

/// What changes from step to step.
struct State {
  BodyId id;
  double position[3], orientation[4], velocity[3], angular_velocity[3], angular_momentum[3];
  std::int32_t image[3];
  std::uint32_t owner : 28, motion : 2, wakefulness : 2;
};

State state_of(const BodyRecord& r, int owner) {
  State s{};
  s.id = r.id;
  s.owner = std::uint32_t(owner);
  s.motion = std::uint32_t(r.motion) & 3;
  s.wakefulness = std::uint32_t(r.wakefulness) & 3;
  std::copy_n(r.position, 3, s.position);
  std::copy_n(r.orientation, 4, s.orientation);
  std::copy_n(r.velocity, 3, s.velocity);
  std::copy_n(r.angular_velocity, 3, s.angular_velocity);
  std::copy_n(r.angular_momentum, 3, s.angular_momentum);
  std::copy_n(r.image, 3, s.image);
  return s;
}

void assign(BodySet& bodies, std::size_t row, const State& s) {
  bodies.position[row] = Eigen::Map<const rigid::Vec3>{s.position};
  bodies.orientation[row] = {s.orientation[0], s.orientation[1], s.orientation[2], s.orientation[3]};
  bodies.velocity[row] = Eigen::Map<const rigid::Vec3>{s.velocity};
  bodies.angular_velocity[row] = Eigen::Map<const rigid::Vec3>{s.angular_velocity};
  bodies.angular_momentum[row] = Eigen::Map<const rigid::Vec3>{s.angular_momentum};
  std::copy_n(s.image, 3, bodies.image[row].begin());
  bodies.motion[row] = rigid::Motion(s.motion);
  bodies.wakefulness[row] = rigid::Wakefulness(s.wakefulness);
}

void put_handover(parallel::Bytes& to, const BodySet& bodies, std::size_t row,
                  const std::vector<int>& holders, int owner) {
  parallel::put(to, bodies.force[row].q);
  parallel::put(to, bodies.torque[row].q);
  std::vector<int> others;
  for (const int r : holders)
    if (r != owner) others.push_back(r);
  parallel::put(to, static_cast<std::uint64_t>(others.size()));
  parallel::put(to, std::span<const int>(others));
  put_impulses(to, bodies.stored_impulses[row]);
}

void take_handover(parallel::ByteReader& from, Traveller& t) {
  t.force.q = from.take<decltype(t.force.q)>();
  t.torque.q = from.take<decltype(t.torque.q)>();
  t.holders.resize(from.take<std::uint64_t>());
  from.take(std::span(t.holders));
  t.impulses = take_impulses(from);
}

void include(std::vector<int>& sorted, int rank) {
  const auto at = std::lower_bound(sorted.begin(), sorted.end(), rank);
  if (at == sorted.end() || *at != rank) sorted.insert(at, rank);
}

/// Inserts where the order of ids in a section of rows asks for it.
std::size_t insert_sorted(BodySet& bodies, std::size_t first, std::size_t& count, const BodyRecord& record) {
  const auto begin = bodies.id.begin() + first;
  const std::size_t row = std::lower_bound(begin, begin + count, record.id) - bodies.id.begin();
  bodies.insert(row, record);
  ++count;
  return row;
}

}  // namespace

struct ParallelBodyExchange::Distribution::Arrivals {
  struct Push {
    BodyId id;
    rigid::FixedVec3 force, torque;
  };
  std::vector<std::uint8_t> updated;  // one a copy
  std::vector<Traveller> copies, own;
  std::vector<Push> pushes;
};

/// The bounding sphere first: most bodies are well inside, whatever their shape.
void ParallelBodyExchange::Distribution::find_holders(int shape, const rigid::Pose& pose,
                                                      std::vector<int>& ranks) const {
  const rigid::Vec3 radius = rigid::Vec3::Constant(world.bounding_radii[shape]);
  holders.ranks_of({pose.position - radius, pose.position + radius}, ranks);
  const int owner = holders.rank_at(pose.position);
  if (ranks.size() > 1 && !rigid::is_sphere(world.shapes[shape]))
    holders.ranks_of(rigid::bounding_box(world.shapes[shape], pose), ranks);
  include(ranks, owner);
}

void ParallelBodyExchange::Distribution::find_holders(const BodySet& bodies, std::size_t row,
                                                      std::vector<int>& ranks) {
  find_holders(bodies.shape[row], bodies.pose(row), ranks);
  if (world.lubrication) include_owners_beyond_films(bodies, row, ranks);
}

void ParallelBodyExchange::Distribution::synchronise(BodySet& bodies, Owners owners) {
  bool rows_changed = drop_visitors(bodies);
  announce(bodies, owners);
  if (owners == Owners::anywhere)
    messages.unannounced();
  else
    messages.with_partners(around);
  Arrivals arrivals;
  arrivals.updated.assign(bodies.copies, 0);
  read(bodies, arrivals);
  rows_changed = settle(bodies, arrivals) || rows_changed;
  if (rows_changed) bodies.reindex();
  add_forces(bodies, arrivals);
  tie(bodies);
}

/// Those on copies go to the owners, and nothing else.
void ParallelBodyExchange::Distribution::sum_forces(BodySet& bodies) {
  expect_all_around();
  send_forces_of_copies(bodies);
  messages.with_partners(around);
  Arrivals arrivals;
  read(bodies, arrivals);
  add_forces(bodies, arrivals);
}

void ParallelBodyExchange::Distribution::add_forces(BodySet& bodies, const Arrivals& arrivals) const {
  for (const Arrivals::Push& p : arrivals.pushes) {
    const std::size_t row = bodies.row_of(p.id);
    if (row >= bodies.size()) continue;  // taken out of the simulation since
    bodies.force[row].add(p.force);
    bodies.torque[row].add(p.torque);
  }
}

/// Each of them waits for a message, if only an empty one.
void ParallelBodyExchange::Distribution::expect_all_around() {
  for (const int other : around) messages.to(other);
}

bool ParallelBodyExchange::Distribution::drop_visitors(BodySet& bodies) {
  velocity_messages_.clear();
  if (bodies.visitors == 0) return false;
  for (; bodies.visitors > 0; --bodies.visitors) {
    const std::size_t last = bodies.first_wall() - 1;
    owner_of.erase(bodies.id[last]);
    bodies.erase(last);
  }
  return true;
}

void ParallelBodyExchange::Distribution::announce(BodySet& bodies, Owners owners) {
  departures_.clear();
  ++round_;
  if (owners != Owners::anywhere) expect_all_around();
  for (std::size_t row = 0; row < bodies.owned; ++row) announce_body(bodies, row, owners);
  std::erase_if(held_by, [&](const auto& held) { return held.second.round != round_; });
  send_forces_of_copies(bodies);
}

void ParallelBodyExchange::Distribution::require_around(BodyId id, int to) const {
  if (std::binary_search(around.begin(), around.end(), to)) return;
  throw std::runtime_error("body " + std::to_string(id) + " has come from rank " + std::to_string(rank) +
                           " to rank " + std::to_string(to) + " at once, further than " +
                           std::to_string(reach) + " cells: use a shorter time step, or fewer ranks");
}

void ParallelBodyExchange::Distribution::announce_body(const BodySet& bodies, std::size_t row,
                                                       Owners owners) {
  const BodyId id = bodies.id[row];
  find_holders(bodies, row, ranks_);
  if (ranks_.size() == 1 && ranks_[0] == rank) return;  // as most
  const auto known = held_by.find(id);
  const int owner = owners == Owners::stay ? rank : holders.rank_at(bodies.position[row]);
  include(ranks_, rank);
  const BodyRecord record = bodies.record(row);
  for (const int to : ranks_) {
    if (to == rank) continue;
    if (owners != Owners::anywhere) require_around(id, to);
    parallel::Bytes& message = messages.to(to);
    const bool has_copy = known != held_by.end() && known->second.has(to);
    if (to != owner && has_copy) {
      parallel::put(message, BodyItem::update);
      parallel::put(message, state_of(record, owner));
      continue;
    }
    parallel::put(message, to == owner ? BodyItem::handover : BodyItem::copy);
    parallel::put(message, record);
    parallel::put(message, owner);
    if (to == owner) put_handover(message, bodies, row, ranks_, owner);
  }
  if (owner != rank) {
    departures_.push_back(row);
    if (known != held_by.end()) held_by.erase(known);
    return;
  }
  auto& [others, round] = held_by[id];
  round = round_;
  others.clear();
  std::copy_if(ranks_.begin(), ranks_.end(), std::back_inserter(others), [&](int r) { return r != rank; });
}

void ParallelBodyExchange::Distribution::send_forces_of_copies(BodySet& bodies) {
  for (std::size_t row = bodies.owned; row < bodies.first_wall(); ++row) {
    if (bodies.force[row].q == rigid::FixedVec3{}.q && bodies.torque[row].q == rigid::FixedVec3{}.q) continue;
    const int to = owner(bodies.id[row]);
    require_around(bodies.id[row], to);
    parallel::Bytes& message = messages.to(to);
    parallel::put(message, BodyItem::force);
    parallel::put(message, bodies.id[row]);
    parallel::put(message, bodies.force[row].q);
    parallel::put(message, bodies.torque[row].q);
    bodies.force[row] = bodies.torque[row] = {};
  }
}

void ParallelBodyExchange::Distribution::read(BodySet& bodies, Arrivals& arrivals) {
  for (const parallel::Messages::Message& m : messages.received())
    for (parallel::ByteReader reader(m.bytes); !reader.done();) {
      const auto item = reader.take<BodyItem>();
      if (item == BodyItem::update) {
        const auto state = reader.take<State>();
        const std::size_t row = bodies.row_of(state.id);
        if (row < bodies.owned || row >= bodies.owned + bodies.copies)
          throw std::logic_error("an update came for body " + std::to_string(state.id) +
                                 ", of which there is no copy");
        assign(bodies, row, state);
        owner_of[state.id] = int(state.owner);
        arrivals.updated[row - bodies.owned] = 1;
      } else if (item == BodyItem::force) {
        Arrivals::Push& p = arrivals.pushes.emplace_back();
        p.id = reader.take<BodyId>();
        p.force.q = reader.take<decltype(p.force.q)>();
        p.torque.q = reader.take<decltype(p.torque.q)>();
      } else {
        Traveller t;
        t.record = reader.take<BodyRecord>();
        t.owner = reader.take<int>();
        if (item == BodyItem::handover) take_handover(reader, t);
        (item == BodyItem::handover ? arrivals.own : arrivals.copies).push_back(std::move(t));
      }
    }
}

/// Rows take their new places, the last sections first so that the numbers of the others hold. True if any
/// did.
bool ParallelBodyExchange::Distribution::settle(BodySet& bodies, Arrivals& arrivals) {
  bool changed = !departures_.empty() || !arrivals.own.empty() || !arrivals.copies.empty();
  for (std::size_t k = arrivals.updated.size(); k-- > 0;) {
    if (arrivals.updated[k]) continue;
    owner_of.erase(bodies.id[bodies.owned + k]);
    bodies.erase(bodies.owned + k);
    --bodies.copies;
    changed = true;
  }
  counters.migrations += departures_.size();
  for (std::size_t k = departures_.size(); k-- > 0;) {
    const BodyRecord record = bodies.record(departures_[k]);
    bodies.erase(departures_[k]);
    --bodies.owned;
    insert_sorted(bodies, bodies.owned, bodies.copies, record);
    owner_of[record.id] = holders.rank_at(Eigen::Map<const rigid::Vec3>{record.position});
  }
  for (Traveller& t : arrivals.own) {
    const std::size_t row = insert_sorted(bodies, 0, bodies.owned, t.record);
    bodies.force[row] = t.force;
    bodies.torque[row] = t.torque;
    bodies.stored_impulses[row] = std::move(t.impulses);
    held_by[t.record.id] = {std::move(t.holders), round_};
  }
  for (const Traveller& t : arrivals.copies) {
    insert_sorted(bodies, bodies.owned, bodies.copies, t.record);
    owner_of[t.record.id] = t.owner;
    ++counters.copies_made;
  }
  return changed;
}

}  // namespace silt::coupler

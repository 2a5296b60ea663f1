// Bodies go to the owners that the cuts give them, wherever they are: all at once, so that rows are made anew
// instead of moved one by one.
#include <algorithm>

#include "coupler/exchange/distribution.hpp"
#include "coupler/exchange/impulse_bytes.hpp"

namespace silt::coupler {

using rigid::BodyRecord;
using rigid::BodySet;

namespace {

/// A body with all that only its owner has.
struct Owned {
  BodyRecord record;
  rigid::FixedVec3 force, torque;
  std::vector<rigid::StoredImpulse> impulses;
};

void put_owned(parallel::Bytes& to, const BodySet& bodies, std::size_t row) {
  parallel::put(to, bodies.record(row));
  parallel::put(to, bodies.force[row].q);
  parallel::put(to, bodies.torque[row].q);
  put_impulses(to, bodies.stored_impulses[row]);
}

Owned take_owned(parallel::ByteReader& from) {
  Owned body;
  body.record = from.take<BodyRecord>();
  body.force.q = from.take<decltype(body.force.q)>();
  body.torque.q = from.take<decltype(body.torque.q)>();
  body.impulses = take_impulses(from);
  return body;
}

/// Owned rows by id, then the walls that there were.
BodySet made_anew(std::vector<Owned>& own, const BodySet& before) {
  std::sort(own.begin(), own.end(), [](const Owned& a, const Owned& b) { return a.record.id < b.record.id; });
  BodySet bodies;
  bodies.resize(own.size() + before.walls);
  bodies.owned = own.size();
  bodies.walls = before.walls;
  std::size_t row = 0;
  for (Owned& body : own) {
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

}  // namespace

void ParallelBodyExchange::Distribution::deal_out(BodySet& bodies) {
  std::vector<Owned> own;
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    const int owner = holders.rank_at(bodies.position[row]);
    if (owner == rank)
      own.push_back({bodies.record(row), bodies.force[row], bodies.torque[row],
                     std::move(bodies.stored_impulses[row])});
    else
      put_owned(messages.to(owner), bodies, row);
  }
  messages.unannounced();
  for (const parallel::Messages::Message& m : messages.received())
    for (parallel::ByteReader reader(m.bytes); !reader.done();) own.push_back(take_owned(reader));
  bodies = made_anew(own, bodies);
  held_by.clear();
  owner_of.clear();
  velocity_messages_.clear();
  synchronise(bodies, Owners::stay);
}

}  // namespace silt::coupler

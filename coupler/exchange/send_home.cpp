#include "coupler/exchange/send_home.hpp"

#include <algorithm>

#include "parallel/collectives.hpp"

namespace silt::coupler {
namespace {

/// Calls each(member) with all that a stored impulse is.
template <class AnyImpulse, class Each>
void for_impulse_members(AnyImpulse& s, Each&& each) {
  each(s.partner), each(s.image), each(s.feature), each(s.held);
  for (int d = 0; d < 3; ++d) each(s.impulse[d]);
}

void put_impulses(parallel::Bytes& to, const std::vector<rigid::StoredImpulse>& impulses) {
  parallel::put(to, static_cast<std::uint64_t>(impulses.size()));
  for (const rigid::StoredImpulse& s : impulses)
    for_impulse_members(s, [&](const auto& member) { parallel::put(to, member); });
}

std::vector<rigid::StoredImpulse> take_impulses(parallel::ByteReader& from) {
  std::vector<rigid::StoredImpulse> impulses(from.take<std::uint64_t>());
  for (rigid::StoredImpulse& s : impulses)
    for_impulse_members(s, [&](auto& member) { member = from.take<std::decay_t<decltype(member)>>(); });
  return impulses;
}

}  // namespace

void put_body(parallel::Bytes& to, const OwnedBody& body) {
  parallel::put(to, body.record);
  parallel::put(to, body.force.q);
  parallel::put(to, body.torque.q);
  put_impulses(to, body.impulses);
}

OwnedBody take_body(parallel::ByteReader& from) {
  OwnedBody body{from.take<rigid::BodyRecord>()};
  body.force.q = from.take<decltype(body.force.q)>();
  body.torque.q = from.take<decltype(body.torque.q)>();
  body.impulses = take_impulses(from);
  return body;
}

std::vector<OwnedBody> sent_home(parallel::Messages& messages, const Holders& holders,
                                 std::vector<OwnedBody> given) {
  const int rank = parallel::rank_of(messages.comm());
  std::vector<OwnedBody> own;
  for (OwnedBody& body : given) {
    const int owner = holders.rank_at(Eigen::Map<const rigid::Vec3>{body.record.position});
    if (owner == rank)
      own.push_back(std::move(body));
    else
      put_body(messages.to(owner), body);
  }
  messages.unannounced();
  for (const parallel::Messages::Message& m : messages.received())
    for (parallel::ByteReader reader(m.bytes); !reader.done();) own.push_back(take_body(reader));
  return own;
}

void send_home(parallel::Messages& messages, const Holders& holders, const SavedBodies& saved,
               rigid::BodySet& bodies, std::size_t at_once) {
  const std::size_t n = saved.records.size(), most = parallel::most_over_ranks(messages.comm(), n);
  for (std::size_t first = 0; first < most; first += at_once) {
    std::vector<OwnedBody> given;
    for (std::size_t i = first; i < std::min(first + at_once, n); ++i)
      given.push_back({.record = saved.records[i], .impulses = saved.impulses[i]});
    for (OwnedBody& body : sent_home(messages, holders, std::move(given))) {
      bodies.add(body.record);
      bodies.stored_impulses[bodies.owned - 1] = std::move(body.impulses);
    }
  }
  bodies.reindex();
}

}  // namespace silt::coupler

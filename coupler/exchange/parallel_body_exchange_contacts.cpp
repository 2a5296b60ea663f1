// Line 13 of Algorithm 1, and the exchange in the sweeps. The rank that owns a contact's point finds it, and
// may own neither body (the paper's Figure 2). It sends the contact to the owners, with the partner's
// record if the owner may lack it: a copy here equals the owner's state bitwise.
#include <algorithm>
#include <map>
#include <string>

#include "coupler/exchange/parallel_body_exchange.hpp"

namespace silt::coupler {

using rigid::BodyId;
using rigid::BodyRecord;
using rigid::BodySet;
using rigid::Contact;

namespace {

enum class ContactItem : std::uint64_t { contact, partner };

/// Calls each(member) for every member of a contact.
template <class AnyContact, class Each>
void for_contact_members(AnyContact& c, Each&& each) {
  each(c.a), each(c.b), each(c.image), each(c.feature);
  for (int d = 0; d < 3; ++d) each(c.normal[d]), each(c.r_a[d]), each(c.r_b[d]);
  each(c.gap), each(c.restitution), each(c.friction), each(c.lubrication), each(c.radii),
      each(c.normal_turns);
}

void put_contact(parallel::Bytes& to, const Contact& c) {
  parallel::put(to, ContactItem::contact);
  for_contact_members(c, [&](const auto& member) { parallel::put(to, member); });
}

Contact read_contact(parallel::ByteReader& from) {
  Contact c;
  for_contact_members(c, [&](auto& member) { member = from.read<std::decay_t<decltype(member)>>(); });
  return c;
}

}  // namespace

/// `contacts` stay sorted; those of a pair come from one rank, in the order of their keys.
void ParallelBodyExchange::exchange_contacts(BodySet& bodies, std::vector<Contact>& contacts) {
  if (ranks_ == 1) return;
  for (const Tie& t : ties_)
    if (!t.received.empty()) messages_.to(t.rank);  // it expects a message, possibly empty
  Pairs crossing;                                   // pairs in contact with one owned body, and received ones
  std::size_t kept = 0, row_a = 0, row_b = 0;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const Contact& c = contacts[k];
    const bool new_pair = k == 0 || c.pair() != contacts[k - 1].pair();
    if (new_pair) row_b = bodies.row_of(c.b);
    if (k == 0 || c.a != contacts[k - 1].a) row_a = bodies.row_of(c.a);
    const bool owns_a = row_a < bodies.owned, owns_b = row_b < bodies.owned;
    if (!owns_a || !(owns_b || rigid::is_wall(c.b))) send_contact(bodies, c, new_pair);
    if (!owns_a && !owns_b) continue;
    if (owns_a != owns_b && !rigid::is_wall(c.b)) crossing.push_back({c.a, c.b});
    if (kept < k) contacts[kept] = contacts[k];
    ++kept;
  }
  contacts.resize(kept);
  messages_.exchange_with(ranks_with(&Tie::sent));
  receive_contacts(bodies, contacts, crossing);
  const auto by_pair = [](const Contact& p, const Contact& q) { return p.pair() < q.pair(); };
  const auto received = contacts.begin() + static_cast<std::ptrdiff_t>(kept);
  std::stable_sort(received, contacts.end(), by_pair);
  std::inplace_merge(contacts.begin(), received, contacts.end(), by_pair);
  plan_velocity_messages(bodies, crossing);
  std::vector<int> partners;
  for (const VelocityMessages& with : velocity_messages_) partners.push_back(with.rank);
  cluster_.begin(rank_, std::move(partners), ranks_);
}

void ParallelBodyExchange::send_contact(const BodySet& bodies, const Contact& c, bool new_pair) {
  const BodyId ids[] = {c.a, c.b};
  int sent_to = rank_;
  for (int end = 0; end < 2; ++end) {
    const BodyId id = ids[end], partner = ids[1 - end];
    if (rigid::is_wall(id) || bodies.row_of(id) < bodies.owned) continue;
    const int to = owner(id);
    if (to != sent_to) put_contact(messages_.to(to), c);
    sent_to = to;
    if (new_pair && !rigid::is_wall(partner)) send_partner(bodies, partner, to);
  }
}

void ParallelBodyExchange::send_partner(const BodySet& bodies, BodyId partner, int to) {
  const std::size_t row = bodies.row_of(partner);
  const bool own = row < bodies.owned;
  const int partners_owner = own ? rank_ : owner(partner);
  if (partners_owner == to) return;
  if (own) {
    const auto held = held_by_.find(partner);
    if (held != held_by_.end() && held->second.has(to)) return;
  }
  parallel::Bytes& message = messages_.to(to);
  parallel::put(message, ContactItem::partner);
  parallel::put(message, bodies.record(row));
  parallel::put(message, partners_owner);
}

/// Appends contacts; unknown partners become visitors, sorted by id.
void ParallelBodyExchange::receive_contacts(BodySet& bodies, std::vector<Contact>& contacts,
                                            Pairs& crossing) {
  std::map<BodyId, BodyRecord> visitors;
  for (const parallel::Messages::Message& m : messages_.received())
    for (parallel::ByteReader reader(m.bytes); !reader.done();) {
      if (reader.read<ContactItem>() == ContactItem::contact) {
        const Contact& c = contacts.emplace_back(read_contact(reader));
        if (!rigid::is_wall(c.b)) crossing.push_back({c.a, c.b});
        continue;
      }
      const auto record = reader.read<BodyRecord>();
      const int partners_owner = reader.read<int>();
      if (bodies.row_of(record.id) < bodies.size()) continue;
      visitors[record.id] = record;
      owner_of_[record.id] = partners_owner;
    }
  if (visitors.empty()) return;
  for (const auto& [id, record] : visitors) {
    bodies.insert(bodies.first_wall(), record);
    ++bodies.visitors;
  }
  bodies.reindex();
}

/// The lists follow from the contacts, which both owners have, so both make the same lists.
void ParallelBodyExchange::plan_velocity_messages(const BodySet& bodies, const Pairs& crossing) {
  velocity_messages_.clear();
  const auto with = [&](int other) -> VelocityMessages& {
    const auto at = std::lower_bound(velocity_messages_.begin(), velocity_messages_.end(), other,
                                     [](const VelocityMessages& s, int r) { return s.rank < r; });
    return at != velocity_messages_.end() && at->rank == other
               ? *at
               : *velocity_messages_.insert(at, {other, {}, {}, {}, {}});
  };
  for (const auto& [id_a, id_b] : crossing) {
    const std::size_t a = bodies.row_of(id_a), b = bodies.row_of(id_b);
    if (a >= bodies.size() || b >= bodies.size())
      throw std::logic_error("a contact names body " + std::to_string(a < b ? id_b : id_a) +
                             ", which is not here");
    if (a < bodies.owned && b < bodies.owned) continue;
    const std::size_t own = std::min(a, b), other = std::max(a, b);  // owned rows come first
    VelocityMessages& sweep = with(owner(bodies.id[other]));
    sweep.sent.push_back(own);
    sweep.received.push_back(other);
  }
  for (VelocityMessages& sweep : velocity_messages_)
    for (auto* rows : {&sweep.sent, &sweep.received}) {
      std::sort(rows->begin(), rows->end(), [&](auto i, auto j) { return bodies.id[i] < bodies.id[j]; });
      rows->erase(std::unique(rows->begin(), rows->end()), rows->end());
    }
}

/// A message has one entry of `sent`, then the rows if any has changed, as its length shows. Both ends know
/// its greatest length, so receives are posted before sends.
void ParallelBodyExchange::share(BodySet&, std::span<double> rows, int width,
                                 std::span<const rigid::EchoReduction::Message> sent,
                                 std::span<rigid::EchoReduction::Message> received, bool changed) {
  for (VelocityMessages& with : velocity_messages_) {
    with.incoming.resize(sent.size_bytes() + with.received.size() * width * sizeof(double));
    sharing_.receive(with.rank, std::span(with.incoming));
  }
  for (VelocityMessages& with : velocity_messages_) {
    with.outgoing.clear();
    parallel::put(with.outgoing, sent);
    if (changed)
      for (const std::size_t row : with.sent)
        parallel::put(with.outgoing, std::span<const double>(rows.subspan(row * width, width)));
    sharing_.send(with.rank, std::span(with.outgoing));
  }
  sharing_.wait();
  for (std::size_t k = 0; k < velocity_messages_.size(); ++k) {
    const VelocityMessages& with = velocity_messages_[k];
    parallel::ByteReader reader(std::span(with.incoming).first(sharing_.bytes_received(k)));
    if (!received.empty()) reader.read(received.subspan(k, 1));
    if (reader.done()) continue;
    for (const std::size_t row : with.received) reader.read(rows.subspan(row * width, width));
  }
}

}  // namespace silt::coupler

#include "coupler/exchange/distribution.hpp"

#include <algorithm>
#include <string>

namespace silt::coupler {

using rigid::BodyId;
using rigid::BodySet;

namespace {

bool is_zero(const rigid::FixedVec3& f) {
  return f.q[0] == 0 && f.q[1] == 0 && f.q[2] == 0;
}

template <class T>
std::span<T> row_of(std::span<T> rows, std::size_t row, int width) {
  return rows.subspan(row * width, width);
}

}  // namespace

const std::vector<int>& ParallelBodyExchange::Distribution::those_that(std::vector<BodyId> Tie::*have) {
  ranks_.clear();
  for (const Tie& t : ties)
    if (!(t.*have).empty()) ranks_.push_back(t.rank);
  return ranks_;
}

int ParallelBodyExchange::Distribution::owner(BodyId id) const {
  const auto found = owner_of.find(id);
  if (found == owner_of.end())
    throw std::logic_error("body " + std::to_string(id) + " has no known owner here");
  return found->second;
}

void ParallelBodyExchange::Distribution::tie(const BodySet& bodies) {
  ties.clear();
  const auto with = [&](int other) -> Tie& {
    const auto at =
        std::lower_bound(ties.begin(), ties.end(), other, [](const Tie& t, int r) { return t.rank < r; });
    return at != ties.end() && at->rank == other ? *at : *ties.insert(at, {other, {}, {}});
  };
  for (std::size_t row = 0; row < bodies.owned; ++row)
    if (const auto found = held_by.find(bodies.id[row]); found != held_by.end())
      for (const int holder : found->second) with(holder).given.push_back(bodies.id[row]);
  for (std::size_t row = bodies.owned; row < bodies.owned + bodies.copies; ++row)
    with(owner(bodies.id[row])).taken.push_back(bodies.id[row]);
}

/// Sends only what is not zero; the sums are of integers, so their order does not matter.
void ParallelBodyExchange::Distribution::sum_forces(BodySet& bodies) {
  for (const Tie& t : ties) {
    if (t.taken.empty()) continue;
    Bytes& message = messages.to(t.rank);
    for (const BodyId id : t.taken) {
      const std::size_t row = bodies.row_of(id);
      if (row >= bodies.size() || (is_zero(bodies.force[row]) && is_zero(bodies.torque[row]))) continue;
      put(message, id);
      put(message, bodies.force[row].q);
      put(message, bodies.torque[row].q);
    }
  }
  for (std::size_t row = bodies.owned; row < bodies.first_wall(); ++row)
    bodies.force[row] = bodies.torque[row] = {};
  messages.with_partners(those_that(&Tie::given));
  for (const Messages::Message& m : messages.received())
    for (ByteReader reader(m.bytes); !reader.done();) {
      const std::size_t row = bodies.row_of(reader.take<BodyId>());
      rigid::FixedVec3 force, torque;
      force.q = reader.take<decltype(force.q)>();
      torque.q = reader.take<decltype(torque.q)>();
      if (row >= bodies.size()) continue;  // taken out of the simulation since
      bodies.force[row].add(force);
      bodies.torque[row].add(torque);
    }
}

void ParallelBodyExchange::Distribution::sum_to_owners(const BodySet& bodies, std::span<std::int64_t> rows,
                                                       int width) {
  for (const Tie& t : ties)
    for (const BodyId id : t.taken) {
      const std::span<std::int64_t> values = row_of(rows, bodies.row_of(id), width);
      put(messages.to(t.rank), std::span<const std::int64_t>(values));
      std::fill(values.begin(), values.end(), 0);
    }
  messages.with_partners(those_that(&Tie::given));
  std::vector<std::int64_t> values(width);
  for (const Messages::Message& m : messages.received()) {
    ByteReader reader(m.bytes);
    const auto t = std::find_if(ties.begin(), ties.end(), [&](const Tie& t) { return t.rank == m.rank; });
    for (const BodyId id : t->given) {
      reader.take(std::span(values));
      const std::span<std::int64_t> sums = row_of(rows, bodies.row_of(id), width);
      for (int k = 0; k < width; ++k) sums[k] += values[k];
    }
  }
}

void ParallelBodyExchange::Distribution::share_with_copies(const BodySet& bodies, std::span<double> rows,
                                                           int width) {
  for (const Tie& t : ties)
    for (const BodyId id : t.given)
      put(messages.to(t.rank), std::span<const double>(row_of(rows, bodies.row_of(id), width)));
  messages.with_partners(those_that(&Tie::taken));
  for (const Messages::Message& m : messages.received()) {
    ByteReader reader(m.bytes);
    const auto t = std::find_if(ties.begin(), ties.end(), [&](const Tie& t) { return t.rank == m.rank; });
    for (const BodyId id : t->taken) reader.take(row_of(rows, bodies.row_of(id), width));
  }
}

}  // namespace silt::coupler

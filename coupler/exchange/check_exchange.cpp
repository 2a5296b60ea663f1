#include "coupler/exchange/check_exchange.hpp"

#include <bit>
#include <cstring>
#include <stdexcept>
#include <string>

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
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0;
};

std::uint64_t hash_of(const std::vector<rigid::StoredImpulse>& impulses) {
  Hash h;
  for (const rigid::StoredImpulse& s : impulses) {
    h.add(s.partner), h.add(s.feature);
    h.add(std::int32_t{s.image.x}), h.add(std::int32_t{s.image.y}), h.add(std::int32_t{s.image.z});
    for (int d = 0; d < 3; ++d) h.add(s.impulse[d]);
  }
  return h.value();
}

[[noreturn]] void fail(rigid::BodyId id, const char* what) {
  throw std::logic_error("body " + std::to_string(id) + ' ' + what);
}

}  // namespace

std::uint64_t hash_of(const rigid::BodyRecord& r) {
  Hash h;
  h.add(r.id), h.add(r.shape), h.add(r.material), h.add(r.kind), h.add(static_cast<std::int32_t>(r.motion));
  h.add(r.mass), h.add(r.weight_factor), h.add(r.inertia_B);
  h.add(r.position), h.add(r.orientation), h.add(r.image);
  h.add(r.velocity), h.add(r.angular_velocity), h.add(r.angular_momentum);
  h.add(r.mapping_position), h.add(r.mapping_orientation);
  for (const std::int64_t x : r.owed) h.add(static_cast<std::uint64_t>(x));
  h.add(r.pending_blow);
  return h.value();
}

OwnedBodies count_owned(MPI_Comm comm, const rigid::BodySet& bodies) {
  std::uint64_t mine[2] = {bodies.owned, 0}, all[2];
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    Hash h;
    h.add(bodies.id[row]);
    mine[1] += h.value();
  }
  MPI_Allreduce(mine, all, 2, MPI_UINT64_T, MPI_SUM, comm);
  return {all[0], all[1]};
}

std::uint64_t state_hash(MPI_Comm comm, const rigid::BodySet& bodies, bool stored_impulses) {
  std::uint64_t mine = 0, all = 0;
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    mine += hash_of(bodies.record(row));
    if (stored_impulses) mine += hash_of(bodies.stored_impulses[row]) ^ bodies.id[row];
  }
  MPI_Allreduce(&mine, &all, 1, MPI_UINT64_T, MPI_SUM, comm);
  return all;
}

void check_bodies(const BodyExchange& exchange, const rigid::BodySet& bodies) {
  std::vector<double> hashes(bodies.size());
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    const std::uint64_t h = hash_of(bodies.record(row));
    std::memcpy(&hashes[row], &h, sizeof h);
  }
  exchange.share_with_copies(bodies, hashes, 1);
  for (std::size_t row = 0; row < bodies.size(); ++row) {
    const rigid::BodyId id = bodies.id[row];
    if (bodies.row_of(id) != row) fail(id, "is here twice, or not where the look-up says");
    if (row >= bodies.owned + bodies.copies) continue;
    if (row > 0 && row != bodies.owned && bodies.id[row - 1] >= id) fail(id, "is out of order");
    if ((exchange.rank_at(bodies.position[row]) == exchange.rank()) != (row < bodies.owned))
      fail(id, "is owned by another rank than the one that holds its centre");
    const std::uint64_t h = hash_of(bodies.record(row));
    if (std::memcmp(&hashes[row], &h, sizeof h) != 0) fail(id, "has a copy that differs from its owner's");
  }
}

}  // namespace silt::coupler

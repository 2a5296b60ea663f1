#include "coupler/state_hash.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <span>
#include <vector>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/flow.hpp"
#include "parallel/collectives.hpp"

namespace silt::coupler {

namespace {

/// The bytes of plain numbers, one after the other, without padding.
class PlainBytes {
 public:
  template <class... T>
  void add(const T&... numbers) {
    (append(&numbers, sizeof numbers), ...);
  }
  void add(const rigid::Vec3& v) { append(v.data(), 3 * sizeof(double)); }
  void clear() { bytes_.clear(); }
  std::uint64_t hash() const { return XXH3_64bits(bytes_.data(), bytes_.size()); }

 private:
  void append(const void* data, std::size_t n) {
    const auto* first = static_cast<const unsigned char*>(data);
    bytes_.insert(bytes_.end(), first, first + n);
  }
  std::vector<unsigned char> bytes_;
};

}  // namespace

std::uint64_t hash_bodies(const rigid::BodySet& bodies) {
  std::uint64_t sum = 0;
  PlainBytes bytes;
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    const rigid::Quat& q = bodies.orientation[row];
    bytes.clear();
    bytes.add(bodies.id[row]);
    bytes.add(bodies.position[row]);
    bytes.add(bodies.image[row], q.w(), q.x(), q.y(), q.z());
    bytes.add(bodies.velocity[row]);
    bytes.add(bodies.angular_momentum[row]);
    for (const std::int64_t x : bodies.holder_state[row].whole(column::impulse_debt)) bytes.add(x);
    bytes.add(rigid::Vec3(pending_impact(bodies, row)));
    for (const rigid::StoredImpulse& s : bodies.stored_impulses[row]) {
      bytes.add(s.partner, s.image.x, s.image.y, s.image.z, s.feature);
      bytes.add(s.impulse);
    }
    sum += bytes.hash();
  }
  return sum;
}

std::uint64_t state_hash(MPI_Comm comm, const Flow* flow, const rigid::BodySet& bodies) {
  return parallel::sum_over_ranks(comm, hash_bodies(bodies) + (flow ? flow->fields().hash() : 0));
}

std::string hex(std::uint64_t x) {
  return fmt::format("{:016x}", x);
}

}  // namespace silt::coupler

#include "coupler/state_hash.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/flow.hpp"
#include "parallel/collectives.hpp"
#include "parallel/messages.hpp"

namespace silt::coupler {

std::uint64_t hash_bodies(const rigid::BodySet& bodies) {
  std::uint64_t sum = 0;
  parallel::Bytes bytes;
  const auto put = [&](const auto&... numbers) { (parallel::put(bytes, numbers), ...); };
  const auto put_vector = [&](const rigid::Vec3& v) { put(v[0], v[1], v[2]); };
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    const rigid::Quat& q = bodies.orientation[row];
    bytes.clear();
    put(bodies.id[row]);
    put_vector(bodies.position[row]);
    put(bodies.image[row], q.w(), q.x(), q.y(), q.z());
    put_vector(bodies.velocity[row]);
    put_vector(bodies.angular_momentum[row]);
    parallel::put(bytes, bodies.holder_state[row].whole(column::impulse_debt));
    put_vector(pending_impact(bodies, row));
    for (const rigid::StoredImpulse& s : bodies.stored_impulses[row]) {
      put(s.partner, s.image.x, s.image.y, s.image.z, s.feature);
      put_vector(s.impulse);
    }
    sum += XXH3_64bits(bytes.data(), bytes.size());
  }
  return sum;
}

std::uint64_t state_hash(MPI_Comm comm, const Flow* flow, const rigid::BodySet& bodies) {
  std::uint64_t sum = hash_bodies(bodies);
  if (flow) flow->for_levels([&](const FluidFields& fields) { sum += fields.hash(); });
  return parallel::sum_over_ranks(comm, sum);
}

std::string hex(std::uint64_t x) {
  return fmt::format("{:016x}", x);
}

}  // namespace silt::coupler

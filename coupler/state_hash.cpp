#include "coupler/state_hash.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/flow.hpp"
#include "parallel/collectives.hpp"
#include "parallel/messages.hpp"

namespace silt::coupler {

/// Lists its columns apart from visit_columns, so that a new column does not change the hash of a state.
std::uint64_t hash_bodies(const rigid::BodySet& bodies) {
  std::uint64_t sum = 0;
  parallel::Bytes bytes;
  const auto put = [&](const auto&... numbers) { (parallel::put(bytes, numbers), ...); };
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    const rigid::Kinematics at = bodies.kinematics(row);
    const CouplingState& coupled = coupling_of(bodies, row);
    bytes.clear();
    put(bodies.id[row], at.position, bodies.image[row], at.orientation, at.velocity, at.angular_momentum);
    put(coupled.impulse_debt, coupled.pending_impact);
    for (const rigid::StoredImpulse& s : bodies.stored_impulses[row])
      put(s.partner, s.image.x, s.image.y, s.image.z, s.feature, s.impulse[0], s.impulse[1], s.impulse[2]);
    sum += XXH3_64bits(bytes.data(), bytes.size());
  }
  return sum;
}

/// Returns the same of id, temperature and heat owed.
static std::uint64_t hash_heat(const rigid::BodySet& bodies) {
  std::uint64_t sum = 0;
  parallel::Bytes bytes;
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    const CouplingState& coupled = coupling_of(bodies, row);
    bytes.clear();
    parallel::put(bytes, bodies.id[row]), parallel::put(bytes, coupled.temperature);
    parallel::put(bytes, coupled.heat_owed);
    sum += XXH3_64bits(bytes.data(), bytes.size());
  }
  return sum;
}

std::uint64_t state_hash(MPI_Comm comm, const Flow* flow, const rigid::BodySet& bodies) {
  std::uint64_t sum = hash_bodies(bodies);
  if (flow && flow->fields().has_temperature()) sum += hash_heat(bodies);
  if (flow) flow->for_levels([&](const FluidFields& fields) { sum += fields.hash(); });
  return parallel::sum_over_ranks(comm, sum);
}

std::string hex(std::uint64_t x) {
  return fmt::format("{:016x}", x);
}

}  // namespace silt::coupler

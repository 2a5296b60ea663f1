#include "coupler/state_hash.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <span>
#include <vector>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/flow.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "lbm/fluid.hpp"
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
    for (const std::int64_t x : coupling_state(bodies, row).impulse_debt) bytes.add(x);
    bytes.add(pending_impact(bodies, row));
    for (const rigid::StoredImpulse& s : bodies.stored_impulses[row]) {
      bytes.add(s.partner, s.image.x, s.image.y, s.image.z, s.feature);
      bytes.add(s.impulse);
    }
    sum += bytes.hash();
  }
  return sum;
}

template <class T>
std::uint64_t hash_fluid(const lbm::Fluid<T>& fluid, std::span<const BlockMap> maps) {
  std::uint64_t sum = 0;
  const lbm::Int3 n = fluid.domain().cells();
  for_fluid_cells(maps, [&](int b, lbm::Int3 x) {
    const lbm::Int3 g = maps[b].box.lower + x;
    struct {
      std::int64_t cell;
      T g[20];  // one spare: no padding bytes in either precision
    } record{(std::int64_t(g.z) * n.y + g.y) * n.x + g.x, {}};
    for (int i = 0; i < lbm::directions; ++i) record.g[i] = fluid.arriving(b, x, i);
    sum += XXH3_64bits(&record, sizeof record);
  });
  return sum;
}

template std::uint64_t hash_fluid(const lbm::Fluid<float>&, std::span<const BlockMap>);
template std::uint64_t hash_fluid(const lbm::Fluid<double>&, std::span<const BlockMap>);

std::uint64_t state_hash(MPI_Comm comm, const Flow* flow, const rigid::BodySet& bodies) {
  return parallel::sum_over_ranks(comm, hash_bodies(bodies) + (flow ? flow->hash() : 0));
}

std::string hex(std::uint64_t x) {
  return fmt::format("{:016x}", x);
}

}  // namespace silt::coupler

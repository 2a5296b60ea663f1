#include "coupler/exchange/send_home.hpp"

#include <algorithm>

#include "coupler/exchange/impulse_bytes.hpp"
#include "parallel/collectives.hpp"

namespace silt::coupler {
namespace {

using rigid::BodyRecord;

void add(rigid::BodySet& bodies, const BodyRecord& record, std::vector<rigid::StoredImpulse> impulses) {
  bodies.add(record);
  bodies.stored_impulses[bodies.owned - 1] = std::move(impulses);
}

}  // namespace

void send_home(parallel::Messages& messages, const Holders& holders, const SavedBodies& saved,
               rigid::BodySet& bodies, std::size_t at_once) {
  const int rank = parallel::rank_of(messages.comm());
  const std::size_t n = saved.records.size(), most = parallel::most_over_ranks(messages.comm(), n);
  for (std::size_t first = 0; first < most; first += at_once) {
    for (std::size_t i = first; i < std::min(first + at_once, n); ++i) {
      const BodyRecord& record = saved.records[i];
      const int owner = holders.rank_at(Eigen::Map<const rigid::Vec3>{record.position});
      if (owner == rank) {
        add(bodies, record, saved.impulses[i]);
        continue;
      }
      parallel::put(messages.to(owner), record);
      put_impulses(messages.to(owner), saved.impulses[i]);
    }
    messages.unannounced();
    for (const parallel::Messages::Message& m : messages.received())
      for (parallel::ByteReader reader(m.bytes); !reader.done();) {
        const auto record = reader.take<BodyRecord>();
        add(bodies, record, take_impulses(reader));
      }
  }
  bodies.reindex();
}

}  // namespace silt::coupler

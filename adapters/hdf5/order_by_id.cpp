#include "adapters/hdf5/order_by_id.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "parallel/collectives.hpp"
#include "parallel/together.hpp"

namespace silt::adapters::hdf5 {
namespace {

constexpr auto none = std::numeric_limits<std::uint64_t>::max();

struct Asked {
  std::uint64_t id;
  int by;
};

/// The ids that all ranks have of this rank's share of the range, in ascending order.
std::vector<Asked> sorted(const parallel::Messages& messages) {
  std::vector<Asked> asked;
  for (const auto& m : messages.received())
    for (parallel::ByteReader reader(m.bytes); !reader.done();)
      asked.push_back({reader.take<std::uint64_t>(), m.rank});
  std::sort(asked.begin(), asked.end(), [](const Asked& a, const Asked& b) { return a.id < b.id; });
  return asked;
}

std::uint64_t least_twice(const std::vector<Asked>& asked) {
  const auto at = std::adjacent_find(asked.begin(), asked.end(),
                                     [](const Asked& a, const Asked& b) { return a.id == b.id; });
  return at == asked.end() ? none : at->id;
}

}  // namespace

IdOrder order_by_id(MPI_Comm comm, std::span<const std::uint64_t> ids) {
  parallel::Messages messages(comm);
  IdOrder result;
  const auto [min, max] = std::minmax_element(ids.begin(), ids.end());
  const std::uint64_t least = parallel::least_over_ranks(comm, ids.empty() ? none : *min);
  const std::uint64_t greatest = parallel::most_over_ranks(comm, ids.empty() ? 0 : *max);
  result.total = parallel::sum_over_ranks(comm, std::uint64_t(ids.size()));
  if (result.total == 0) return result;

  const int ranks = parallel::ranks_of(comm);
  const auto range = static_cast<unsigned __int128>(greatest - least) + 1;
  parallel::together(comm, [&] {
    result.rows.resize(ids.size());
    std::iota(result.rows.begin(), result.rows.end(), std::size_t{0});
    std::sort(result.rows.begin(), result.rows.end(),
              [&](std::size_t a, std::size_t b) { return ids[a] < ids[b]; });
    for (const std::size_t i : result.rows)
      parallel::put(
          messages.to(static_cast<int>(static_cast<unsigned __int128>(ids[i] - least) * ranks / range)),
          ids[i]);
    messages.make_room();
  });
  std::vector<Asked> asked;
  parallel::together(comm, [&] {
    messages.unannounced();
    asked = sorted(messages);
  });
  std::uint64_t number = parallel::sum_of_ranks_before(comm, std::uint64_t(asked.size()));
  const std::uint64_t twice = parallel::least_over_ranks(comm, least_twice(asked));
  if (twice != none) result.twice = twice;
  parallel::together(comm, [&] {  // each rank is answered in the order of the ids it has
    for (const Asked& a : asked) parallel::put(messages.to(a.by), number++);
    messages.make_room();
  });
  parallel::together(comm, [&] {
    messages.unannounced();
    for (const auto& m : messages.received())
      for (parallel::ByteReader reader(m.bytes); !reader.done();)
        append_run(result.places, {reader.take<std::uint64_t>(), 1});
  });
  return result;
}

}  // namespace silt::adapters::hdf5

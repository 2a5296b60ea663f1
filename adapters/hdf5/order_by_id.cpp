#include "adapters/hdf5/order_by_id.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>

#include "adapters/hdf5/together.hpp"

namespace silt::adapters::hdf5 {
namespace {

constexpr auto none = std::numeric_limits<std::uint64_t>::max();

struct Asked {
  std::uint64_t id;
  int by;
};

/// The ids that all ranks have of this rank's share of the range, in ascending order.
std::vector<Asked> sorted(const std::vector<SparseMessages::Message>& received) {
  std::vector<Asked> asked;
  for (const auto& m : received)
    for (std::size_t at = 0; at < m.bytes.size(); at += sizeof(std::uint64_t)) {
      Asked& a = asked.emplace_back(Asked{0, m.rank});
      std::memcpy(&a.id, m.bytes.data() + at, sizeof a.id);
    }
  std::sort(asked.begin(), asked.end(), [](const Asked& a, const Asked& b) { return a.id < b.id; });
  return asked;
}

std::uint64_t least_twice(const std::vector<Asked>& asked) {
  const auto at = std::adjacent_find(asked.begin(), asked.end(),
                                     [](const Asked& a, const Asked& b) { return a.id == b.id; });
  return at == asked.end() ? none : at->id;
}

/// Answers with the number of each id, to every rank in the order of the ids it has.
std::vector<SparseMessages::Message> answers(const std::vector<Asked>& asked, std::uint64_t number,
                                             const std::vector<SparseMessages::Message>& received) {
  std::vector<SparseMessages::Message> sent;
  for (const auto& m : received) sent.push_back({m.rank, {}});
  for (const Asked& a : asked) {
    const auto to =
        std::lower_bound(sent.begin(), sent.end(), a.by,
                         [](const SparseMessages::Message& m, int rank) { return m.rank < rank; });
    put(to->bytes, number++);
  }
  return sent;
}

}  // namespace

IdOrder order_by_id(MPI_Comm comm, std::span<const std::uint64_t> ids) {
  SparseMessages messages(comm);
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  IdOrder result;
  std::uint64_t bounds[2] = {none, none}, n = ids.size();  // the least, and none less the greatest
  for (const std::uint64_t id : ids) {
    bounds[0] = std::min(bounds[0], id);
    bounds[1] = std::min(bounds[1], none - id);
  }
  MPI_Allreduce(MPI_IN_PLACE, bounds, 2, MPI_UINT64_T, MPI_MIN, comm);
  MPI_Allreduce(&n, &result.total, 1, MPI_UINT64_T, MPI_SUM, comm);
  if (result.total == 0) return result;

  const auto range = static_cast<unsigned __int128>(none - bounds[1] - bounds[0]) + 1;
  std::vector<SparseMessages::Message> sent;
  together(comm, [&] {
    result.rows.resize(ids.size());
    std::iota(result.rows.begin(), result.rows.end(), std::size_t{0});
    std::sort(result.rows.begin(), result.rows.end(),
              [&](std::size_t a, std::size_t b) { return ids[a] < ids[b]; });
    for (const std::size_t i : result.rows) {
      const auto to = static_cast<int>(static_cast<unsigned __int128>(ids[i] - bounds[0]) * ranks / range);
      if (sent.empty() || sent.back().rank != to) sent.push_back({to, {}});
      put(sent.back().bytes, ids[i]);
    }
  });
  const auto received = messages.swap(sent);
  std::vector<Asked> asked;
  together(comm, [&] { asked = sorted(received); });
  std::uint64_t mine = asked.size(), before = 0, twice = least_twice(asked);
  MPI_Exscan(&mine, &before, 1, MPI_UINT64_T, MPI_SUM, comm);
  MPI_Allreduce(MPI_IN_PLACE, &twice, 1, MPI_UINT64_T, MPI_MIN, comm);
  if (twice != none) result.twice = twice;
  together(comm, [&] { sent = answers(asked, before, received); });
  const auto answered = messages.swap(sent);
  together(comm, [&] {
    for (const auto& m : answered)
      for (std::size_t at = 0; at < m.bytes.size(); at += sizeof(std::uint64_t)) {
        std::uint64_t place = 0;
        std::memcpy(&place, m.bytes.data() + at, sizeof place);
        append_run(result.places, {place, 1});
      }
  });
  return result;
}

}  // namespace silt::adapters::hdf5

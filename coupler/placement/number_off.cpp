#include "coupler/placement/number_off.hpp"

#include <algorithm>

#include "parallel/collectives.hpp"

namespace silt::coupler {
namespace {

struct Asked {
  std::uint64_t key;
  int rank;
};

int slice_of(std::uint64_t key, std::uint64_t range, int ranks) {
  return static_cast<int>(static_cast<unsigned __int128>(key) * ranks / range);
}

/// What all ranks ask of this slice, in the order of keys.
std::vector<Asked> gathered(const parallel::Messages& messages) {
  std::vector<Asked> asked;
  for (const parallel::Messages::Message& m : messages.received())
    for (parallel::ByteReader reader(m.bytes); !reader.done();)
      asked.push_back({reader.take<std::uint64_t>(), m.rank});
  std::sort(asked.begin(), asked.end(), [](const Asked& a, const Asked& b) { return a.key < b.key; });
  return asked;
}

}  // namespace

std::vector<std::uint64_t> number_off(parallel::Messages& messages, const std::vector<std::uint64_t>& keys,
                                      std::uint64_t range) {
  const int ranks = parallel::ranks_of(messages.comm());
  for (const std::uint64_t key : keys) parallel::put(messages.to(slice_of(key, range, ranks)), key);
  messages.unannounced();
  const std::vector<Asked> asked = gathered(messages);
  std::uint64_t before = parallel::sum_of_ranks_before(messages.comm(), asked.size());
  for (const Asked& a : asked) parallel::put(messages.to(a.rank), before++);
  messages.unannounced();
  std::vector<std::uint64_t> numbers;  // slices answer in the order of ranks, which is that of keys
  for (const parallel::Messages::Message& m : messages.received())
    for (parallel::ByteReader reader(m.bytes); !reader.done();)
      numbers.push_back(reader.take<std::uint64_t>());
  return numbers;
}

}  // namespace silt::coupler

#include "coupler/placement/number_off.hpp"

#include <algorithm>

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
std::vector<Asked> gathered(const Messages& messages) {
  std::vector<Asked> asked;
  for (const Messages::Message& m : messages.received())
    for (ByteReader reader(m.bytes); !reader.done();) asked.push_back({reader.take<std::uint64_t>(), m.rank});
  std::sort(asked.begin(), asked.end(), [](const Asked& a, const Asked& b) { return a.key < b.key; });
  return asked;
}

}  // namespace

std::vector<std::uint64_t> number_off(Messages& messages, const std::vector<std::uint64_t>& keys,
                                      std::uint64_t range) {
  int ranks = 1;
  MPI_Comm_size(messages.comm(), &ranks);
  for (const std::uint64_t key : keys) put(messages.to(slice_of(key, range, ranks)), key);
  messages.unannounced();
  const std::vector<Asked> asked = gathered(messages);
  std::uint64_t mine = asked.size(), before = 0;
  MPI_Exscan(&mine, &before, 1, MPI_UINT64_T, MPI_SUM, messages.comm());
  for (const Asked& a : asked) put(messages.to(a.rank), before++);
  messages.unannounced();
  std::vector<std::uint64_t> numbers;  // slices answer in the order of ranks, which is that of keys
  for (const Messages::Message& m : messages.received())
    for (ByteReader reader(m.bytes); !reader.done();) numbers.push_back(reader.take<std::uint64_t>());
  return numbers;
}

}  // namespace silt::coupler

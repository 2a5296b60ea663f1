#include "coupler/placement/first_faults.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

namespace silt::coupler {
namespace {

constexpr auto none = std::numeric_limits<std::uint64_t>::max();

std::uint64_t least(MPI_Comm comm, std::uint64_t x) {
  MPI_Allreduce(MPI_IN_PLACE, &x, 1, MPI_UINT64_T, MPI_MIN, comm);
  return x;
}

/// The text of the lowest rank that has it.
std::string told_to_all(MPI_Comm comm, bool have, std::string text) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  const auto speaker = static_cast<int>(least(comm, have ? rank : none));
  std::uint64_t size = text.size();
  MPI_Bcast(&size, 1, MPI_UINT64_T, speaker, comm);
  text.resize(size);
  MPI_Bcast(text.data(), static_cast<int>(size), MPI_CHAR, speaker, comm);
  return text;
}

}  // namespace

std::vector<BodyFault> first_faults(MPI_Comm comm, std::vector<BodyFault> mine, std::size_t most) {
  std::sort(mine.begin(), mine.end(), [](const BodyFault& a, const BodyFault& b) {
    return std::tie(a.body, a.other) < std::tie(b.body, b.other);
  });
  std::vector<BodyFault> first;
  auto next = mine.begin();
  while (first.size() < most) {
    const rigid::BodyId body = least(comm, next == mine.end() ? none : next->body);
    if (body == none) break;
    const bool of_body = next != mine.end() && next->body == body;
    const rigid::BodyId other = least(comm, of_body ? next->other : none);
    const bool have = of_body && next->other == other;
    first.push_back({body, other, told_to_all(comm, have, have ? next->text : "")});
    while (next != mine.end() && next->body == body && next->other == other) ++next;
  }
  return first;
}

}  // namespace silt::coupler

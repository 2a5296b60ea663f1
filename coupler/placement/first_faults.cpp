#include "coupler/placement/first_faults.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

#include "parallel/collectives.hpp"
#include "parallel/together.hpp"

namespace silt::coupler {
namespace {

constexpr auto none = std::numeric_limits<std::uint64_t>::max();

}  // namespace

std::vector<BodyFault> first_faults(MPI_Comm comm, std::vector<BodyFault> mine, std::size_t most) {
  std::sort(mine.begin(), mine.end(), [](const BodyFault& a, const BodyFault& b) {
    return std::tie(a.body, a.other) < std::tie(b.body, b.other);
  });
  std::vector<BodyFault> first;
  auto next = mine.begin();
  while (first.size() < most) {
    const rigid::BodyId body = parallel::least_over_ranks(comm, next == mine.end() ? none : next->body);
    if (body == none) break;
    const bool of_body = next != mine.end() && next->body == body;
    const rigid::BodyId other = parallel::least_over_ranks(comm, of_body ? next->other : none);
    const bool have = of_body && next->other == other;
    first.push_back({body, other, parallel::text_of_first(comm, have ? next->text : "")});
    while (next != mine.end() && next->body == body && next->other == other) ++next;
  }
  return first;
}

}  // namespace silt::coupler

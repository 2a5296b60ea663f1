#include "coupler/placement/given_bodies.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

#include "parallel/together.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

std::uint64_t count_given(const Case& setup) {
  std::uint64_t n = 0;
  setup.for_each_given([&](const BodySpec&, std::uint64_t count) { n += count; });
  return n;
}

double mean_width(const Case& setup, std::span<const GivenBody> bodies) {
  double sum = 0;
  for (const GivenBody& body : bodies) sum += 2 * rigid::bounding_radius(setup.shapes[body.spec.shape]);
  return bodies.empty() ? 1 : std::max(1.0, sum / static_cast<double>(bodies.size()));
}

int entry_of(const Case& setup, rigid::BodyId id) {
  if (id <= setup.bodies.size()) return setup.bodies[id - 1].entry;
  id -= setup.bodies.size();
  auto filed = setup.filed.begin();
  for (; id > filed->contents.points; ++filed) id -= filed->contents.points;
  return filed->alike.entry;
}

std::vector<GivenBody> given_bodies(const Case& setup, Surroundings& around) {
  std::vector<GivenBody> bodies;
  for (std::size_t i = 0; i < setup.bodies.size(); ++i) {
    const BodySpec& spec = setup.bodies[i];
    const bool own = around.is_here(spec.pose.position);
    const auto& near = around.ranks_near(rigid::bounding_box(setup.shapes[spec.shape], spec.pose));
    if (own || std::binary_search(near.begin(), near.end(), around.rank))
      bodies.push_back({i + 1, spec, own});
  }
  add_filed_bodies(setup, around, bodies);
  return bodies;
}

std::vector<BodyFault> first_faults(MPI_Comm comm, std::vector<BodyFault> mine, std::size_t most) {
  constexpr auto none = std::numeric_limits<std::uint64_t>::max();
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

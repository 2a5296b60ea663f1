#include "coupler/placement/lattice_fill.hpp"

#include <algorithm>
#include <cmath>

#include "coupler/case/case.hpp"
#include "coupler/case/counter_random.hpp"

namespace silt::coupler {
namespace {

using rigid::Vec3;

/// Uniform in a ball.
Vec3 moved_within(double radius, CounterRandom& random) {
  for (;;) {
    const Vec3 x = 2 * random.point() - Vec3::Ones();
    if (x.squaredNorm() <= 1) return radius * x;
  }
}

/// The indices along an axis of sites that may lie in a block, each once.
std::vector<std::int64_t> sites_met(const Lattice& lattice, int axis, const lbm::CellBox& box, double shift) {
  constexpr double rows_and_layers = 2;  // steps by which they may be shifted, and rounding
  const std::int64_t n = lattice.sites()[axis];
  const double step = lattice.step(axis), lower = box.lower[axis] - lattice.first(axis) - shift,
               upper = box.lower[axis] + box.size[axis] - lattice.first(axis) + shift;
  auto first = static_cast<std::int64_t>(std::floor(lower / step - rows_and_layers));
  auto last = static_cast<std::int64_t>(std::ceil(upper / step + 1));
  if (!lattice.goes_round(axis)) {
    first = std::max<std::int64_t>(first, 0);
    last = std::min(last, n - 1);
  } else if (last - first + 1 > n) {
    first = 0;
    last = n - 1;
  }
  std::vector<std::int64_t> met;
  for (std::int64_t i = first; i <= last; ++i) met.push_back((i % n + n) % n);
  return met;
}

}  // namespace

std::vector<FilledBody> fill_sites(const Case& scene, FillApplication application, double radius,
                                   const Lattice& lattice, const Surroundings& around,
                                   const Obstacles& obstacles) {
  const FillSpec& fill = scene.fills[application.fill];
  const std::uint64_t stream = mixed(fill.seed) ^ mixed(~application.stream());
  std::vector<FilledBody> bodies;
  const auto look_at = [&](int block, const Lattice::Index& i) {
    const Vec3 site = lattice.site(i);
    if (!lattice.in_room(site)) return;
    CounterRandom random(mixed(lattice.number(i) + stream));
    FilledBody body{lattice.number(i), site + moved_within(fill.shift, random), rigid::Quat::Identity()};
    std::array<std::int32_t, 3> image{};
    around.extent.wrap(body.centre, image);
    if (around.holders.block_at(body.centre) != block) return;
    if (!obstacles.is_free(body.centre, radius, fill.gap)) return;
    if (!fill.aligned) body.orientation = random.orientation();
    bodies.push_back(body);
  };
  for (const auto& [block, box, rank] : around.domain.blocks_of(around.rank)) {
    std::array<std::vector<std::int64_t>, 3> met;
    for (int d = 0; d < 3; ++d) met[d] = sites_met(lattice, d, box, fill.shift);
    for (const std::int64_t z : met[2])
      for (const std::int64_t y : met[1])
        for (const std::int64_t x : met[0]) look_at(block, {x, y, z});
  }
  std::sort(bodies.begin(), bodies.end(), [](const auto& a, const auto& b) { return a.number < b.number; });
  return bodies;
}

void add_to_obstacles(const std::vector<FilledBody>& bodies, Surroundings& around, Obstacles& obstacles) {
  for (const FilledBody& body : bodies) {
    obstacles.add_ball(body.centre);
    for (const int rank : around.ranks_near({body.centre, body.centre}))
      if (rank != around.rank)
        for (int d = 0; d < 3; ++d) parallel::put(around.messages.to(rank), body.centre[d]);
  }
  around.messages.unannounced();
  for (const parallel::Messages::Message& m : around.messages.received())
    for (parallel::ByteReader reader(m.bytes); !reader.done();) {
      Vec3 centre;
      for (int d = 0; d < 3; ++d) centre[d] = reader.take<double>();
      obstacles.add_ball(centre);
    }
}

}  // namespace silt::coupler

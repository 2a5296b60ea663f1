#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coupler/case/counter_random.hpp"
#include "coupler/placement/one_fill.hpp"

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

/// Returns bodies on the free sites that lie here, each moved by at most the fill's shift in any direction,
/// in the order of their numbers, which are those of the sites.
std::vector<FilledBody> on_free_sites(const OneFill& fill, const Lattice& lattice) {
  const FillSpec& spec = fill.spec;
  const Surroundings& around = fill.around;
  const std::uint64_t key = fill.application.key(spec);
  std::vector<FilledBody> bodies;
  const auto look_at = [&](int block, const Lattice::Index& i) {
    const Vec3 site = lattice.site(i);
    if (!lattice.in_room(site)) return;
    CounterRandom random(mixed(lattice.number(i) + key));
    FilledBody body{lattice.number(i), site + moved_within(spec.shift, random)};
    std::array<std::int32_t, 3> image{};
    around.extent.wrap(body.centre, image);
    if (around.holders.block_at(body.centre) != block) return;
    if (!fill.obstacles.is_free(body.centre, fill.radius, spec.gap)) return;
    if (!spec.aligned) body.orientation = random.orientation();
    bodies.push_back(body);
  };
  for (const auto& [block, box, rank] : around.domain.blocks_of(around.rank)) {
    std::array<std::vector<std::int64_t>, 3> met;
    for (int d = 0; d < 3; ++d) met[d] = sites_met(lattice, d, box, spec.shift);
    for (const std::int64_t z : met[2])
      for (const std::int64_t y : met[1])
        for (const std::int64_t x : met[0]) look_at(block, {x, y, z});
  }
  std::sort(bodies.begin(), bodies.end(), [](const auto& a, const auto& b) { return a.number < b.number; });
  return bodies;
}

/// Adds bodies placed here, and those that others placed near, to the obstacles.
void add_to_obstacles(const std::vector<FilledBody>& bodies, Surroundings& around, Obstacles& obstacles) {
  using Centre = std::array<double, 3>;
  for (const FilledBody& body : bodies) {
    const Vec3& x = body.centre;
    obstacles.add_ball(x);
    around.tell_others_near({x, x}, Centre{x[0], x[1], x[2]});
  }
  around.messages.unannounced();
  around.messages.for_received<Centre>([&](const Centre& x, int) { obstacles.add_ball({x[0], x[1], x[2]}); });
}

}  // namespace

/// The first sites that are free, as many as asked for or all.
Filling fill_sites(const OneFill& fill) {
  const auto count = static_cast<std::uint64_t>(fill.count);
  const std::size_t index = fill.application.fill;
  const Lattice lattice = lattice_of(fill.setup, fill.application, fill.radius);
  std::vector<FilledBody> bodies = on_free_sites(fill, lattice);
  set_places(bodies, std::max<std::uint64_t>(1, lattice.total()), fill.around);
  const std::uint64_t sites = fill.around.sum(bodies.size());
  if (fill.application.is_first() && sites < std::max<std::uint64_t>(count, 1))
    throw CaseError(fill.setup.place(fmt::format("fill[{}].count", index)),
                    fmt::format("fill[{}].count is {}, but there are only {} free sites; lower count, gap or "
                                "spacing, or enlarge box or domain",
                                index, count, sites));
  const std::uint64_t total = count > 0 ? std::min(count, sites) : sites;
  std::erase_if(bodies, [&](const FilledBody& body) { return body.place >= total; });
  add_to_obstacles(bodies, fill.around, fill.obstacles);
  return {std::move(bodies), total};
}

}  // namespace silt::coupler

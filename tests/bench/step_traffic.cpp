#include "tests/bench/step_traffic.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/mapping/mapping_poses.hpp"
#include "rigid/rigid_step.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case.hpp"

namespace silt::bench {

using lbm::CellBox;
using lbm::Int3;

namespace {

/// The cells of a box, moved by a step, that lie in another or one of its images.
std::int64_t shared_cells(const CellBox& box, Int3 step, const CellBox& other, Int3 period) {
  std::int64_t product = 1;
  for (int d = 0; d < 3; ++d) {
    std::int64_t along = 0;
    for (int image = -1; image <= 1; ++image) {
      const int lower = std::max(box.lower[d] + step[d], other.lower[d] + image * period[d]);
      const int upper =
          std::min(box.lower[d] + box.size[d] + step[d], other.lower[d] + other.size[d] + image * period[d]);
      along += std::max(0, upper - lower);
    }
    product *= along;
  }
  return product;
}

/// The boxes of a rank's neighbours, itself left out.
template <class Visit>
void for_neighbours(const lbm::Domain& domain, int rank, Visit&& visit) {
  for (const int b : domain.neighbourhood(rank))
    if (b != rank) visit(domain.block(b).box);
}

bool are_near(const CellBox& a, const CellBox& b, Int3 period, double reach) {
  for (int d = 0; d < 3; ++d) {
    double gap = period[d];
    for (int image = -1; image <= 1; ++image) {
      const int shift = image * period[d];
      gap = std::min<double>(gap, std::max(b.lower[d] + shift - (a.lower[d] + a.size[d]),
                                           a.lower[d] - (b.lower[d] + b.size[d] + shift)));
    }
    if (gap >= reach) return false;
  }
  return true;
}

template <class Visit>
void for_cells_at_faces(const CellBox& box, Visit&& visit) {
  const Int3 last = box.size - Int3{1, 1, 1};
  coupler::for_cells({}, box.size, [&](Int3 x) {
    if (x.x == 0 || x.y == 0 || x.z == 0 || x.x == last.x || x.y == last.y || x.z == last.z)
      visit(box.lower + x);
  });
}

/// The cells with their centres inside the spheres that a rank knows, where the next step maps them.
std::set<std::array<int, 3>> cells_in_spheres(const Simulation& simulation) {
  const Scene& scene = simulation.scene();
  const rigid::World& world = scene.exchange->world();
  rigid::BodySet bodies = simulation.bodies();
  coupler::renew_mapping_poses(bodies, world, scene.exchange->extent(), scene.setup.coupling,
                               simulation.steps_done());
  std::set<std::array<int, 3>> cells;
  for (std::size_t row = 0; row < bodies.first_wall(); ++row) {
    const rigid::Vec3 centre = coupler::mapping_pose(bodies, row).position;
    const double radius = std::get<rigid::Sphere>(world.shapes[bodies.shape[row]]).radius;
    const int reach = int(radius) + 2;
    const Int3 low{int(centre[0]) - reach, int(centre[1]) - reach, int(centre[2]) - reach};
    coupler::for_cells(low, low + Int3{2 * reach, 2 * reach, 2 * reach}, [&](Int3 x) {
      if ((rigid::Vec3(x.x + 0.5, x.y + 0.5, x.z + 0.5) - centre).norm() > radius) return;
      const Int3 cell = scene.domain.wrapped(x);
      cells.insert({cell.x, cell.y, cell.z});
    });
  }
  return cells;
}

}  // namespace

Sent halo_sent(const lbm::Domain& domain, int rank, int number) {
  const CellBox mine = domain.block(rank).box;
  Sent sent;
  for_neighbours(domain, rank, [&](const CellBox& theirs) {
    std::int64_t crossing = 0;
    for (int i = 1; i < lbm::D3Q19::directions; ++i)
      crossing += shared_cells(mine, lbm::D3Q19::c[i], theirs, domain.cells()) +
                  shared_cells(theirs, lbm::D3Q19::c[i], mine, domain.cells());
    if (crossing > 0) sent += {1, 0.5 * double(crossing) * number};
  });
  return sent;
}

Sent pairs_sent(const Simulation& simulation, int number) {
  const Scene& scene = simulation.scene();
  const lbm::Domain& domain = scene.domain;
  const std::set<std::array<int, 3>> solid = cells_in_spheres(simulation);
  const auto is_solid = [&](Int3 x) {
    x = domain.wrapped(x);
    return solid.count({x.x, x.y, x.z}) > 0;
  };
  const CellBox mine = domain.block(scene.rank()).box;
  std::map<int, int> pairs;  // by rank
  for (int i = 1; i < lbm::D3Q19::directions; ++i)
    for_cells_at_faces(mine, [&](Int3 behind) {
      const Int3 x = behind + lbm::D3Q19::c[i];
      const int reader = domain.block_at(domain.wrapped(x)).rank;
      if (reader != scene.rank() && !is_solid(x) && is_solid(x + lbm::D3Q19::c[i])) ++pairs[reader];
    });
  Sent sent;
  for (const auto& [rank, count] : pairs) sent += {1, 2.0 * count * number};
  return sent;
}

int ranks_within(const lbm::Domain& domain, int rank, double reach) {
  const CellBox mine = domain.block(rank).box;
  int others = 0;
  for (int r = 0; r < domain.ranks(); ++r)
    others += r != rank && are_near(mine, domain.block(r).box, domain.cells(), reach);
  return others;
}

std::set<int> copied_from(const Simulation& simulation) {
  const rigid::BodySet& bodies = simulation.bodies();
  std::set<int> ranks;
  for (std::size_t row = bodies.owned; row < bodies.owned + bodies.copies; ++row)
    ranks.insert(simulation.scene().exchange->owner_of(bodies, row));
  return ranks;
}

std::set<int> copied_to(const Simulation& simulation, double ahead) {
  rigid::BodySet then = simulation.bodies();
  rigid::drift(then, then.owned, ahead);
  const coupler::ParallelBodyExchange& exchange = *simulation.scene().exchange;
  std::set<int> ranks;
  for (std::size_t row = 0; row < then.owned; ++row) {
    const std::vector<int> holders = exchange.holders(then, row);
    ranks.insert(holders.begin(), holders.end());
  }
  ranks.erase(exchange.rank());
  return ranks;
}

}  // namespace silt::bench

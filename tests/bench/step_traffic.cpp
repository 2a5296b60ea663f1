#include "tests/bench/step_traffic.hpp"

#include <algorithm>

#include "rigid/integrate.hpp"

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

}  // namespace

Sent halo_sent(const lbm::Domain& domain, int rank, int number) {
  const CellBox mine = domain.block(rank).box;
  Sent sent;
  for_neighbours(domain, rank, [&](const CellBox& theirs) {
    std::int64_t crossing = 0;
    for (int i = 1; i < lbm::directions; ++i)
      crossing += shared_cells(mine, lbm::c[i], theirs, domain.cells()) +
                  shared_cells(theirs, lbm::c[i], mine, domain.cells());
    if (crossing > 0) sent += {1, 0.5 * double(crossing) * number};
  });
  return sent;
}

Sent pairs_sent(const lbm::Domain& domain, int rank, int number) {
  const CellBox mine = domain.block(rank).box;
  Sent sent;
  for_neighbours(domain, rank, [&](const CellBox& theirs) {
    std::int64_t pairs = 0;
    for (int i = 1; i < lbm::directions; ++i) pairs += shared_cells(mine, lbm::c[i], theirs, domain.cells());
    if (pairs > 0) sent += {1, 2.0 * double(pairs) * number};
  });
  return sent;
}

int ranks_within(const lbm::Domain& domain, int rank, double reach) {
  const CellBox mine = domain.block(rank).box;
  int others = 0;
  for (int r = 0; r < domain.ranks(); ++r)
    others += r != rank && are_near(mine, domain.block(r).box, domain.cells(), reach);
  return others;
}

std::set<int> copied_from(const coupler::Simulation& simulation) {
  const rigid::BodySet& bodies = simulation.bodies();
  std::set<int> ranks;
  for (std::size_t row = bodies.owned; row < bodies.owned + bodies.copies; ++row)
    ranks.insert(simulation.scene().exchange->owner_of(bodies, row));
  return ranks;
}

std::set<int> copied_to(const coupler::Simulation& simulation, double ahead) {
  rigid::BodySet then = simulation.bodies();
  rigid::drift(then, ahead);
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

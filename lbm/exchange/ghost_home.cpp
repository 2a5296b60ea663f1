#include "lbm/exchange/ghost_home.hpp"

#include <limits>

namespace silt::lbm {

template <class Lattice>
Home home_of(const Domain& domain, Int3 g, int j) {
  if (domain.inside(g)) return {HomeKind::slot, g, j};
  Int3 cell = g, direction = Lattice::c[j];
  Home outlet{HomeKind::slot, {}, 0};
  double pressure = std::numeric_limits<double>::infinity();
  for (int d = 0; d < 3; ++d) {
    if (domain.periodic(d) || (cell[d] >= 0 && cell[d] < domain.cells()[d])) continue;
    const bool upper = cell[d] >= domain.cells()[d];
    const SideCondition& side = domain.side(d, upper);
    const SideKind kind = side.kind;
    if (kind == SideKind::bounce) return {HomeKind::bounce, g - Lattice::c[j], opposite(j), 2 * d + upper};
    if (is_outlet(kind) && side.value <= pressure) {  // where two meet the lesser pressure holds
      outlet = {HomeKind::outlet, g - Lattice::c[j], opposite(j), 2 * d + upper};
      pressure = side.value;
    }
    if (kind == SideKind::free_slip) {  // mirrors cell and direction
      cell[d] = upper ? 2 * domain.cells()[d] - 1 - cell[d] : -1 - cell[d];
      direction[d] = -direction[d];
    }
  }
  if (outlet.kind == HomeKind::outlet) return outlet;
  return {HomeKind::slot, domain.wrapped(cell), direction_of<Lattice>(direction)};
}

template <class Lattice>
double wall_addend(const Domain& domain, Int3 sides, int j) {
  return -6 * Lattice::w(j) * domain.wall_velocity_along(sides, Lattice::c[j]);
}

template <class Lattice>
Flight one_step(const Domain& fine, Flight p) {
  const Int3 g = p.cell + Lattice::c[p.direction];
  const Home home = home_of<Lattice>(fine, g, p.direction);
  if (home.kind == HomeKind::bounce) p.addend += wall_addend<Lattice>(fine, fine.walls_met(g), p.direction);
  p.by_outlet |= home.kind == HomeKind::outlet;
  p.cell = home.cell, p.direction = home.direction;
  return p;
}

template <class Lattice>
Flight step_back(const Domain& fine, Flight p) {
  p.direction = opposite(p.direction);
  p = one_step<Lattice>(fine, p);
  p.direction = opposite(p.direction);
  return p;
}

template Home home_of<D3Q19>(const Domain&, Int3, int);
template Home home_of<D3Q7>(const Domain&, Int3, int);
template double wall_addend<D3Q19>(const Domain&, Int3, int);
template double wall_addend<D3Q7>(const Domain&, Int3, int);
template Flight one_step<D3Q19>(const Domain&, Flight);
template Flight one_step<D3Q7>(const Domain&, Flight);
template Flight step_back<D3Q19>(const Domain&, Flight);
template Flight step_back<D3Q7>(const Domain&, Flight);

const BlockPlace& Leaves::at(Int3 cell) {
  for (const BlockPlace& place : recent_)
    if (place.box.contains(cell)) return place;
  next_ = (next_ + 1) % recent_.size();
  return recent_[next_] = domain_.block_at(cell);
}

}  // namespace silt::lbm

#include "lbm/exchange/ghost_home.hpp"

namespace silt::lbm {

Home home_of(const Domain& domain, Int3 g, int j) {
  if (domain.inside(g)) return {HomeKind::slot, g, j};
  Int3 cell = g, direction = c[j];
  Home pressure{HomeKind::slot, {}, 0};
  for (int d = 0; d < 3; ++d) {
    if (domain.periodic(d) || (cell[d] >= 0 && cell[d] < domain.cells()[d])) continue;
    const bool upper = cell[d] >= domain.cells()[d];
    switch (domain.side(d, upper).kind) {
      case SideKind::bounce:
        return {HomeKind::bounce, g - c[j], opposite(j), d, upper};
      case SideKind::pressure:
        pressure = {HomeKind::outlet, g - c[j], opposite(j), d, upper};
        break;
      case SideKind::periodic:  // has been left out
        break;
      case SideKind::free_slip:  // the mirror image of cell and direction
        cell[d] = upper ? 2 * domain.cells()[d] - 1 - cell[d] : -1 - cell[d];
        direction[d] = -direction[d];
    }
  }
  if (pressure.kind == HomeKind::outlet) return pressure;
  return {HomeKind::slot, domain.wrapped(cell), direction_of(direction)};
}

double wall_addend(const Domain& domain, Int3 sides, int j) {
  return -6 * w(j) * domain.wall_velocity_along(sides, j);
}

Flight one_step(const Domain& fine, Flight p) {
  const Int3 g = p.cell + c[p.direction];
  const Home home = home_of(fine, g, p.direction);
  if (home.kind == HomeKind::bounce) p.addend += wall_addend(fine, fine.walls_met(g), p.direction);
  p.by_outlet |= home.kind == HomeKind::outlet;
  p.cell = home.cell, p.direction = home.direction;
  return p;
}

Flight step_back(const Domain& fine, Flight p) {
  p.direction = opposite(p.direction);
  p = one_step(fine, p);
  p.direction = opposite(p.direction);
  return p;
}

const BlockPlace& Leaves::at(Int3 cell) {
  for (const BlockPlace& place : recent_)
    if (place.box.contains(cell)) return place;
  next_ = (next_ + 1) % recent_.size();
  return recent_[next_] = domain_.block_at(cell);
}

}  // namespace silt::lbm

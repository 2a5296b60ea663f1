#include "lbm/packet_flight.hpp"

#include "lbm/ghost_home.hpp"

namespace silt::lbm {

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

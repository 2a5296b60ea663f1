#pragma once
// A lattice of up to three levels whose borders have convex and concave edges and corners, and a flow through
// it.
#include <array>
#include <cmath>
#include <numbers>

#include "tests/lbm/levelled_flow.hpp"

namespace silt::lbm::testing {

using Sides = std::array<SideCondition, 6>;

/// Made of tiles of 8 cells there is an L of finest cells, so that edges and corners are convex and concave,
/// with a margin of the next level, in `levels` coarser ones.
inline int bent(Int3 x, int levels) {
  const Int3 t{x.x / 8, x.y / 8, x.z / 8};
  const auto in = [&](int low, int high) {
    return t.x >= low && t.x < high && t.y >= low && t.y < high && t.z >= low && t.z < high;
  };
  if (in(2, 4) && !(t.x == 2 && t.y == 2) && !(t.y == 3 && t.z == 3)) return 0;
  return levels == 1 || in(0, 6) ? 1 : 2;
}

inline Sides all(const SideCondition& side) {
  Sides sides;
  sides.fill(side);
  return sides;
}

template <class T>
void stir(LevelledFlow<T>& flow, Int3 n) {
  const double k = 2 * std::numbers::pi;
  flow.set([&](const Vector& x, double& rho, Vector& u, std::array<Vector, 3>&) {
    rho = 0.01 * std::sin(k * (x[0] / n.x + 2 * x[1] / n.y));
    u = {0.03 * std::sin(k * (x[1] / n.y + x[2] / n.z)), 0.02 * std::cos(2 * k * x[0] / n.x),
         0.03 * std::sin(k * (x[0] / n.x - x[1] / n.y))};
  });
}

}  // namespace silt::lbm::testing

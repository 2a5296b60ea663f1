#pragma once
// The homes of populations that leave a block: a cell across its face, through a periodic image or as in a
// mirror, or their own cell, from a wall or an outlet; and the way of a packet of a population from fine cell
// to fine cell (method-fluid.md, "Levels").
#include <array>

#include "lbm/blocks/domain.hpp"

namespace silt::lbm {

enum class HomeKind { slot, bounce, outlet };

struct Home {
  HomeKind kind;
  Int3 cell;  // global
  int direction;
  int side = -1;  // of the domain, for bounce and outlet
};

/// Returns the home of the population that left along j into the ghost cell g (global, unwrapped).
template <class Lattice>
Home home_of(const Domain& domain, Int3 g, int j);

/// Returns what moving walls add to the population that left along j and meets these sides.
template <class Lattice>
double wall_addend(const Domain& domain, Int3 sides, int j);

/// Fine cells have coordinates of their own level, so a coarse cell has those of twice its own and the next.
constexpr Int3 corner(int k) {
  return {k & 1, k >> 1 & 1, k >> 2 & 1};
}
constexpr Int3 halved(Int3 x) {
  return {x.x >> 1, x.y >> 1, x.z >> 1};
}

struct Flight {
  Int3 cell;
  int direction;
  double addend = 0;       // by walls that it met
  double by_force = 0;     // what the force adds on the way
  bool by_outlet = false;  // it met one
};

template <class Lattice>
Flight one_step(const Domain& fine, Flight);
/// Every way can be gone back, walls and images included.
template <class Lattice>
Flight step_back(const Domain& fine, Flight);

/// Leaves finds those of cells that lie near one another.
class Leaves {
 public:
  explicit Leaves(const Domain& domain) : domain_(domain) {}
  const BlockPlace& at(Int3 cell);
  int level(Int3 cell) { return domain_.tree().kinds()[at(cell).index].level; }

 private:
  const Domain& domain_;
  std::array<BlockPlace, 8> recent_{};
  std::size_t next_ = 0;
};

}  // namespace silt::lbm

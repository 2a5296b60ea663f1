#pragma once
// Finds the home of a population that leaves a block: a cell across the face, through periodic sides and
// mirrors, or its own cell if a wall or an outlet returns it. Follows packets of populations from fine cell
// to fine cell (method-fluid.md, "Levels").
#include <array>

#include "lbm/blocks/domain.hpp"

namespace silt::lbm {

enum class HomeKind { slot, bounce, outlet };

struct Home {
  HomeKind kind;
  Int3 cell;  // global
  int direction;
  int side = -1;  // index of the side of the domain, for bounce and outlet
};

/// Returns the home of the population that left along j into ghost cell g (global, before periodic wrapping).
template <class Lattice>
Home home_of(const Domain& domain, Int3 g, int j);

/// Returns the amount that the motion of walls adds to a population that left along j and meets these sides.
template <class Lattice>
double wall_addend(const Domain& domain, Int3 sides, int j);

/// Returns corner k of a coarse cell: its fine cells are at 2 x + corner(k), x being its coordinates.
constexpr Int3 corner(int k) {
  return {k & 1, k >> 1 & 1, k >> 2 & 1};
}
constexpr Int3 halved(Int3 x) {
  return {x.x >> 1, x.y >> 1, x.z >> 1};
}

struct Flight {
  Int3 cell;
  int direction;
  double addend = 0;       // by walls on the way
  double by_force = 0;     // by the force on the way
  bool by_outlet = false;  // an outlet returned it
};

template <class Lattice>
Flight one_step(const Domain& fine, Flight);
/// The inverse of one_step(): every way can be reversed, through walls and periodic images too.
template <class Lattice>
Flight step_back(const Domain& fine, Flight);

/// Looks up the leaf of a cell; keeps recent leaves, so that cells near one another are found quickly.
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

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

/// Calls visit(home, way, ghosts, j) for the ghost cells of a block that populations along j enter, box after
/// box: the cells of `ghosts` (global, before periodic wrapping) lie `way` from cells of the leaf `home`. No
/// cells beyond sides that are not periodic are visited.
template <class Lattice, class Visit>
void for_ghost_boxes(const Domain& domain, const CellBox& block, Visit&& visit) {
  domain.for_images_meeting(grown(block, 1), [&](const BlockPlace& home, Int3 way) {
    const CellBox image{home.box.lower + way, home.box.size};
    for (int j = 1; j < Lattice::directions && !(image == block); ++j) {
      const CellBox ghosts = overlap(image, {block.lower + Lattice::c[j], block.size});
      if (ghosts.cells() > 0) visit(home, way, ghosts, j);
    }
  });
}

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

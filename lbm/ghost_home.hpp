#pragma once
// Where a population goes that leaves a block: into a cell across its face, through a periodic image or as in
// a mirror, or back into its own cell from a wall or an outlet.
#include "lbm/domain.hpp"

namespace silt::lbm {

enum class HomeKind { slot, bounce, outlet };

struct Home {
  HomeKind kind;
  Int3 cell;  // global
  int direction;
  int axis = -1;  // of the wall, for bounce and outlet
  bool upper = false;
};

/// The home of the population that left along j into the ghost cell g (global, unwrapped).
Home home_of(const Domain& domain, Int3 g, int j);

/// What moving walls add to what left along j and meets these sides.
double wall_addend(const Domain& domain, Int3 sides, int j);

}  // namespace silt::lbm

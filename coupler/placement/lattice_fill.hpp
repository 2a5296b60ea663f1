#pragma once
// A fill on the sites of a lattice: each rank takes those of its blocks that are free.
#include <cstddef>
#include <vector>

#include "coupler/case/fill_room.hpp"
#include "coupler/placement/filled_body.hpp"
#include "coupler/placement/obstacles.hpp"
#include "coupler/placement/surroundings.hpp"

namespace silt::coupler {

/// Returns bodies on the free sites that lie here, each moved by at most the fill's shift in any direction,
/// in the order of their numbers, which are those of the sites. Adds nothing to the obstacles.
std::vector<FilledBody> fill_sites(const Case&, FillApplication, double radius, const Lattice&,
                                   const Surroundings&, const Obstacles&);

/// Collective. Adds bodies placed here, and those that others placed near, to the obstacles.
void add_to_obstacles(const std::vector<FilledBody>&, Surroundings&, Obstacles&);

}  // namespace silt::coupler

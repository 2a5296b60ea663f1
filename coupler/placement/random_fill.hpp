#pragma once
// Random sequential addition on many ranks, the same bodies to the bit on any number of them.
//
// Points rain on the room for the bodies' centres, a Poisson process in space and time, and a body is placed
// where one falls unless it would meet what is there: the first `count` that stay are the fill. As a point's
// time is a function of (seed, cell, draw), nobody needs to know them all: whether one stays depends on
// earlier points less than a diameter away, and on those in turn on which these depend. Ranks draw the points
// of their own blocks, tell those near a border to the ranks there, and decide those of which all such points
// are decided, to and fro until none is left. Only how many have stayed is asked of all ranks, and when the
// last one fell.
#include <cstddef>
#include <vector>

#include "coupler/case/fill_room.hpp"
#include "coupler/placement/filled_body.hpp"
#include "coupler/placement/obstacles.hpp"
#include "coupler/placement/surroundings.hpp"

namespace silt::coupler {

struct RandomlyFilled {
  std::vector<FilledBody> bodies;  // that lie here, in the order of their numbers
  std::uint64_t range, total;      // numbers are below; how many there are on all ranks
};

/// Collective. Places the bodies of a fill, of a bounding radius, in the room for their centres. Balls of
/// this radius have been begun in the obstacles, to which it adds those placed here and near. If they do not
/// all fit: CaseError on every rank at the first application; at a later one there are fewer.
RandomlyFilled fill_at_random(const Case&, FillApplication, double radius, const rigid::BoundingBox& room,
                              Surroundings&, Obstacles&);

}  // namespace silt::coupler

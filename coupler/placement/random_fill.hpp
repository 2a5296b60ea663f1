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

#include "coupler/placement/filled_body.hpp"
#include "coupler/placement/obstacles.hpp"
#include "coupler/placement/surroundings.hpp"

namespace silt::coupler {

/// Collective. Places the bodies of a fill, of a bounding radius, in the room for their centres; returns
/// those that lie here in the order of their numbers, which are below `range`. Balls of this radius have been
/// begun in the obstacles, to which it adds those placed here and near. CaseError on every rank if they do
/// not fit.
std::vector<FilledBody> fill_at_random(const Case&, std::size_t fill, double radius,
                                       const rigid::BoundingBox& room, Surroundings&, Obstacles&,
                                       std::uint64_t& range);

}  // namespace silt::coupler

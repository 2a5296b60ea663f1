#pragma once
// The work that bodies make, from what a rank knows of its own: where the parts that were not counted are,
// estimated.
#include "coupler/balance/work_costs.hpp"
#include "coupler/balance/work_map.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"

namespace silt::coupler {

/// Links that cross a unit of surface, mean over its directions: half the sum of |c_i . n| over the 18
/// directions, where the mean of |cos| is a half: (6 + 12 sqrt(2)) / 4.
inline constexpr double links_of_a_surface = 5.743;

/// Adds the work of the bodies owned here as bodies: their motion, and their contacts as of the last step.
void add_bodies(const rigid::BodySet&, const WorkCosts&, WorkMap&);

/// Adds an estimate of what mapping and the cut links of bodies owned here will take, from volumes and
/// surfaces alone, as if those that move were mapped every ninth step.
void add_surfaces(const rigid::BodySet&, const rigid::World&, const WorkCosts&, WorkMap&);

/// Adds that work as it is in a block that has been mapped: its links, and their mapping from one to the next
/// of each body, a body's estimated as above and spread over its cells.
void add_mapped(const BlockMap&, const rigid::BodySet&, const rigid::World&, const WorkCosts&, WorkMap&);

}  // namespace silt::coupler

#pragma once
// Costs of the parts of a step, and the work of a rank's bodies, counted or estimated.
#include "coupler/balance/work_map.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"

namespace silt::coupler {

struct FlowSpec;

/// Costs in tenths of the update of a fluid cell in single precision: integers, so that sums and the
/// resulting cuts are the same on every machine. Ratios measured on one core (tests/bench/README.md):
/// `scripts/bench fluid` and `links` for cells and links, `coupled` for mapping, `bed` and `dry` for bodies.
struct WorkCosts {
  WorkCosts(const FlowSpec&, int substeps);

  std::int64_t cell = 0;     // 0 without a fluid
  std::int64_t link = 0;     // per cut link
  std::int64_t mapping = 0;  // per cut link, whenever its body is mapped
  std::int64_t body = 0;     // per moving body, in all sub-steps
  std::int64_t impulse = 0;  // per stored impulse, in all sub-steps; both bodies of a contact store it
};

/// Mean number of links through a unit of surface over its orientations: half the sum of |c_i . n| over the
/// 18 directions, with mean |cos| = 1/2: (6 + 12 sqrt(2)) / 4.
inline constexpr double links_of_a_surface = 5.743;

/// Adds the dynamics of bodies owned here: their motion, and their contacts in the last step.
void add_bodies(const rigid::BodySet&, const WorkCosts&, WorkMap&);

/// Adds an estimate of mapping and cut links of bodies owned here, from volumes and surfaces, as if moving
/// bodies were mapped every ninth step.
void add_surfaces(const rigid::BodySet&, const rigid::World&, const WorkCosts&, WorkMap&);

/// Adds the same work for a block that has been mapped: its counted links, and the mapping of each body,
/// estimated as above and distributed over its cells.
void add_mapped(const BlockMap&, const rigid::BodySet&, const rigid::World&, const WorkCosts&, WorkMap&);

}  // namespace silt::coupler

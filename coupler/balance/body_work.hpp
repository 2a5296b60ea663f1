#pragma once
// The costs of the parts of a step, and the work that bodies make, from the bodies that a rank owns: counted,
// or estimated where nothing was counted.
#include "coupler/balance/work_map.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"

namespace silt::coupler {

struct FlowSpec;

/// WorkCosts are in tenths of a fluid cell in single precision: whole numbers, so that sums, and the cuts
/// that follow from them, are the same on every machine. Ratios measured on one core (tests/bench/README.md):
/// `scripts/bench fluid` and `links` for cells and links, `coupled` for mapping, `bed` and `dry` for bodies.
struct WorkCosts {
  WorkCosts(const FlowSpec&, int substeps);

  std::int64_t cell = 0;     // 0 without a fluid
  std::int64_t link = 0;     // cut link
  std::int64_t mapping = 0;  // of a cut link, each time its body is mapped
  std::int64_t body = 0;     // that moves, all sub-steps
  std::int64_t impulse = 0;  // remembered by a body, all sub-steps; a contact is remembered by both bodies
};

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

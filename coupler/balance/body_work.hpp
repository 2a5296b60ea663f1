#pragma once
// The work of bodies and levels of cells, by which domains are cut, and where it is, by tiles, sparsely.
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "coupler/mapping/solid_map.hpp"
#include "lbm/blocks/domain.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

/// Work distributed evenly over a box of cells.
struct WorkItem {
  lbm::CellBox box;
  std::int64_t work;
};

class WorkMap {
 public:
  static constexpr int tile = 8;  // cells
  explicit WorkMap(const lbm::Domain&);

  /// Adds work at a point, wrapped along periodic axes and clamped into the domain along others.
  void add(const rigid::Vec3& x_W, std::int64_t work);
  /// Distributes work over the cells of a box, with positions outside the domain treated as above.
  void add(const rigid::BoundingBox& box_W, std::int64_t work);
  /// Adds work in the tile of a cell of the domain.
  void add(lbm::Int3 cell, std::int64_t work);
  /// Returns the tiles with work, in order.
  std::vector<WorkItem> items() const;

 private:
  int cell_along(int axis, double x) const;
  lbm::Int3 cells_, tiles_;
  bool periodic_[3];
  std::unordered_map<std::int64_t, std::int64_t> work_;  // by tile number, x fastest
};

/// Returns the work of one finest step in a leaf of known level, with `work_of_a_cell` for the update of a
/// cell in its own step: a cell of level l stands for 8^l finest cells and is updated in one of 2^l steps.
/// Exchange through the leaf's faces with cells of the next level is added; it costs more the shorter the
/// rows in a face are (lbm/method-fluid.md, "Levels").
std::int64_t work_of_leaf(const lbm::Domain& view, int leaf, std::int64_t work_of_a_cell);

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

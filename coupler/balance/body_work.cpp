#include "coupler/balance/body_work.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/spec/flow_spec.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

using lbm::Int3;

WorkMap::WorkMap(const lbm::Domain& domain) : cells_(domain.cells()) {
  for (int d = 0; d < 3; ++d) {
    tiles_[d] = (cells_[d] + tile - 1) / tile;
    periodic_[d] = domain.periodic(d);
  }
}

void WorkMap::add(Int3 cell, std::int64_t work) {
  const std::int64_t x = cell.x / tile, y = cell.y / tile, z = cell.z / tile;
  if (work != 0) work_[(z * tiles_.y + y) * tiles_.x + x] += work;
}

int WorkMap::cell_along(int axis, double x) const {
  const int n = cells_[axis];
  if (periodic_[axis]) x -= std::floor(x / n) * n;
  return !(x >= 0) ? 0 : x >= n ? n - 1 : int(x);
}

void WorkMap::add(const rigid::Vec3& x, std::int64_t work) {
  add(Int3{cell_along(0, x[0]), cell_along(1, x[1]), cell_along(2, x[2])}, work);
}

/// Represents the box by points half a tile apart, at most most_points along an edge, each with its share.
void WorkMap::add(const rigid::BoundingBox& box, std::int64_t work) {
  constexpr double most_points = 32;
  std::array<int, 3> points;
  rigid::Vec3 step;
  for (int d = 0; d < 3; ++d) {
    const double length = std::min(box.upper[d] - box.lower[d], double(cells_[d]));
    points[d] = int(std::clamp(std::ceil(2 * length / tile), 1., most_points));
    step[d] = length / points[d];
  }
  const std::int64_t all = std::int64_t(points[0]) * points[1] * points[2];
  std::int64_t n = 0;
  for (int z = 0; z < points[2]; ++z)
    for (int y = 0; y < points[1]; ++y)
      for (int x = 0; x < points[0]; ++x, ++n)
        add(rigid::Vec3(box.lower + step.cwiseProduct(rigid::Vec3(x + 0.5, y + 0.5, z + 0.5))),
            work / all + (n < work % all));
}

std::vector<WorkItem> WorkMap::items() const {
  std::vector<std::pair<std::int64_t, std::int64_t>> sorted(work_.begin(), work_.end());
  std::sort(sorted.begin(), sorted.end());
  std::vector<WorkItem> items;
  for (const auto& [number, work] : sorted) {
    const Int3 at{int(number % tiles_.x), int(number / tiles_.x % tiles_.y),
                  int(number / tiles_.x / tiles_.y)};
    lbm::CellBox box;
    for (int d = 0; d < 3; ++d) {
      box.lower[d] = tile * at[d];
      box.size[d] = std::min(int(tile), cells_[d] - box.lower[d]);
    }
    items.push_back({box, work});
  }
  return items;
}

namespace {
/// The cost, in updates of fine cells, of a coarse cell at a face across each axis in each of the two fine
/// steps; measured on one core with fifty regions of 28 cells an edge.
constexpr std::array<std::int64_t, 3> updates_at_a_face = {60, 30, 15};
}  // namespace

std::int64_t work_of_leaf(const lbm::Domain& view, int leaf, std::int64_t work_of_a_cell) {
  const int level = view.tree().kinds()[leaf].level;
  const lbm::Domain coarser(view.tree(), view.sides(), view.ranks(), level + 1);
  const lbm::CellBox box = coarser.block(leaf).box;
  std::int64_t updates = view.tree().leaf(leaf).box.cells() >> 3 * level;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool high : {false, true}) {
      lbm::CellBox beyond = box;
      beyond.lower[axis] += high ? box.size[axis] : -1;
      beyond.size[axis] = 1;
      beyond.lower = coarser.wrapped(beyond.lower);
      if (!coarser.inside(beyond.lower)) continue;
      coarser.for_blocks_meeting(beyond, [&](const lbm::BlockPlace& there) {
        updates += updates_at_a_face[axis] * lbm::overlap(there.box, beyond).cells();
      });
    }
  return (work_of_a_cell * updates) >> level;
}

using rigid::Motion;

WorkCosts::WorkCosts(const FlowSpec& setup, int substeps) {
  body = 1500 * substeps;
  impulse = 1000 * substeps;
  if (!setup.fluid) return;
  cell = setup.fluid->precision == Precision::single_ ? 10 : 20;  // by memory bandwidth
  if (setup.heat) cell += cell * 3 / 5;
  link = setup.coupling.time == TimeCoupling::explicit_ ? 26 : 30;
  mapping = 90;
}

namespace {

/// Calls visit(x, n) for the pieces, n cells from x on, into which tiles divide a row of a block.
template <class Visit>
void for_pieces(const lbm::CellBox& block, Int3 first, int end, Visit&& visit) {
  Int3 x = first;
  for (x.x = std::max(x.x, 0); x.x < std::min(end, block.size.x);) {
    const int left_of_tile = WorkMap::tile - (block.lower.x + x.x) % WorkMap::tile;
    const int n = std::min(std::min(end, block.size.x) - x.x, left_of_tile);
    visit(x, n);
    x.x += n;
  }
}

/// Returns the number of cut links of n cells in a row, without links to cells beyond a side of the domain.
int links_from(const BlockMap& map, Int3 x, int n) {
  const std::uint64_t fluid = first_cells(~map.solid.from(x.x, x.y, x.z), n);
  int links = 0;
  for (int i = 1; i < lbm::D3Q19::directions; ++i) {
    const Int3 y = x + lbm::D3Q19::c[i];
    links += std::popcount(fluid & map.solid.from(y.x, y.y, y.z) & ~map.walls.from(y.x, y.y, y.z));
  }
  return links;
}

/// Returns whether a solid cell is in or next to this row.
bool any_solid(const BlockMap& map, int y, int z) {
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int k = 0; k < map.solid.words(); ++k)
        if (map.solid.at(y + dy, z + dz)[k] & ~map.walls.at(y + dy, z + dz)[k]) return true;
  return false;
}

/// Returns twice the contacts of a body, where a contact is shared equally with a partner that stores it as
/// well, and counts fully if the partner is a wall or a body that does not move freely.
std::int64_t half_contacts(const rigid::BodySet& bodies, std::size_t row) {
  std::int64_t halves = 0;
  for (const rigid::StoredImpulse& s : bodies.stored_impulses[row]) {
    const std::size_t partner = bodies.row_of(s.partner);
    const bool alone = rigid::is_wall(s.partner) || (partner < bodies.size() && !bodies.is_dynamic(partner));
    halves += alone ? 2 : 1;
  }
  return halves;
}

/// Returns whether a body is mapped repeatedly.
bool is_mapped(const rigid::BodySet& bodies, std::size_t row) {
  return bodies.motion[row] != Motion::fixed;
}

/// Steps between mappings at 0.01 cells a step, assumed for bodies that have not moved yet.
constexpr std::int64_t usual_steps = 9;

std::int64_t steps_mapped(const rigid::BodySet& bodies, std::size_t row) {
  const auto& steps = coupling_of(bodies, row).mapped.steps;
  return steps.end > steps.first ? steps.end - steps.first : usual_steps;
}

/// Returns cut links per cell of a shape whose surface is 6 volume / least width (spheres, cubes).
double links_a_cell(const rigid::Shape& shape) {
  return links_of_a_surface * 6 / rigid::least_width(shape);
}

}  // namespace

void add_bodies(const rigid::BodySet& bodies, const WorkCosts& costs, WorkMap& work) {
  for (std::size_t row = 0; row < bodies.owned; ++row)
    if (bodies.motion[row] != Motion::fixed)
      work.add(bodies.position[row], costs.body + costs.impulse * half_contacts(bodies, row));
}

void add_surfaces(const rigid::BodySet& bodies, const rigid::World& world, const WorkCosts& costs,
                  WorkMap& work) {
  if (costs.cell == 0) return;
  std::vector<double> links_of(world.shapes.size(), -1);
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    const rigid::Shape& shape = world.shapes[bodies.shape[row]];
    double& links = links_of[bodies.shape[row]];
    if (links < 0) links = links_a_cell(shape) * rigid::mass_properties(shape).volume;
    const std::int64_t mapping = is_mapped(bodies, row) ? costs.mapping / usual_steps : 0;
    work.add(rigid::bounding_box(shape, bodies.pose(row)),
             std::llround(links * double(costs.link + mapping)));
  }
}

void add_mapped(const BlockMap& map, const rigid::BodySet& bodies, const rigid::World& world,
                const WorkCosts& costs, WorkMap& work) {
  const Int3 size = map.box.size;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      if (any_solid(map, y, z))
        for_pieces(map.box, {0, y, z}, size.x,
                   [&](Int3 x, int n) { work.add(map.box.lower + x, costs.link * links_from(map, x, n)); });
  std::vector<double> links_of(world.shapes.size(), -1);  // per cell
  for (const BodyMask& mask : map.masks) {
    if (mask.row >= bodies.first_wall() || !is_mapped(bodies, mask.row)) continue;
    double& links = links_of[bodies.shape[mask.row]];
    if (links < 0) links = links_a_cell(world.shapes[bodies.shape[mask.row]]);
    const std::int64_t of_a_cell =
        std::llround(links * double(costs.mapping) / double(steps_mapped(bodies, mask.row)));
    const BitFrame& f = mask.frame();
    for (int z = std::max(f.low.z, 0); z < std::min(f.low.z + f.size.z, size.z); ++z)
      for (int y = std::max(f.low.y, 0); y < std::min(f.low.y + f.size.y, size.y); ++y)
        for (int k = 0; k < f.pitch; k += 64) {
          const std::uint64_t cells = mask.bits.row(k, y, z);
          const int first = f.low.x + k, end = f.low.x + std::min(k + 64, f.size.x);
          if (cells)
            for_pieces(map.box, {first, y, z}, end, [&](Int3 x, int n) {
              work.add(map.box.lower + x, of_a_cell * std::popcount(first_cells(cells >> (x.x - first), n)));
            });
        }
  }
}

}  // namespace silt::coupler

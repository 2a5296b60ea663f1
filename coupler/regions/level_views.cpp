#include "coupler/regions/level_views.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/exchange/holders.hpp"
#include "lbm/blocks/equal_cut.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

using lbm::CellBox;
using lbm::Int3;
using lbm::LevelBox;
using rigid::Vec3;

namespace {

constexpr double furthest = 1 << 28;  // limit of coordinates, cells

Int3 floor_of(const Vec3& x) {
  Int3 cell;
  for (int d = 0; d < 3; ++d) cell[d] = int(std::floor(std::clamp(x[d], -furthest, furthest)));
  return cell;
}
Int3 ceil_of(const Vec3& x) {
  const Int3 cell = floor_of(-x);
  return {-cell.x, -cell.y, -cell.z};
}

/// Divides integers, rounding towards minus infinity.
int floor_div(int x, int n) {
  return x >= 0 ? x / n : -((n - 1 - x) / n);
}

/// Returns the distance by which a level's cells extend beyond the cells of the finer level.
int growth(const CoarseningSpec& spec, int level) {
  return int(std::ceil(spec.distance * (1 << level)));
}

double distance_to(const rigid::Shape& surface, const Vec3& x_B) {
  if (const auto* mesh = std::get_if<rigid::Mesh>(&surface)) return mesh->surface->nearest(x_B).distance;
  return std::abs(rigid::signed_distance(surface, x_B));
}

}  // namespace

FineBoxes::FineBoxes(const FlowSpec& flow, std::vector<rigid::BoundingBox> entrances)
    : flow_(flow),
      spec_(*flow.coarsening),
      entrances_(std::move(entrances)),
      cells_{flow.cells[0], flow.cells[1], flow.cells[2]} {
  while (2 * wall_tile_ <= spec_.distance) wall_tile_ *= 2;
}

int FineBoxes::plane_below(int axis, int x, int spacing) const {
  const int n = cells_[axis];
  if (!flow_.periodic(axis) && (x <= 0 || x >= n)) return std::clamp(x, 0, n);
  const int period = floor_div(x, n) * n, within = x - period;
  const int plane = within / spacing * spacing;
  return period + (plane > 0 && plane + spacing > n ? plane - spacing : plane);
}

int FineBoxes::plane_above(int axis, int x, int spacing) const {
  const int below = plane_below(axis, x, spacing), n = cells_[axis];
  if (below >= x) return below;
  const int end = flow_.periodic(axis) ? (floor_div(x, n) + 1) * n : n;
  return below + 2 * spacing > end ? end : below + spacing;
}

CellBox FineBoxes::rounded(Int3 lower, Int3 upper, int spacing) const {
  CellBox box;
  for (int d = 0; d < 3; ++d) {
    box.lower[d] = plane_below(d, lower[d], spacing);
    box.size[d] = plane_above(d, upper[d], spacing) - box.lower[d];
  }
  return box;
}

CellBox FineBoxes::around(const rigid::BoundingBox& box) const {
  const Vec3 distance = Vec3::Constant(spec_.distance);
  return rounded(floor_of(box.lower - distance), ceil_of(box.upper + distance), tile(0));
}

int FineBoxes::reach() const {
  int reach = 0;
  for (int l = 0; l < spec_.levels; ++l) reach += growth(spec_, l) + 2 * std::max(tile(l), wall_tile_);
  return reach;
}

void FineBoxes::add(CellBox box, int level, std::vector<LevelBox>& boxes) const {
  for (; level < spec_.levels; ++level) {
    std::vector<CellBox> pieces = {box};
    for (int d = 0; d < 3; ++d) {
      const int n = cells_[d];
      const std::size_t count = pieces.size();
      for (std::size_t k = 0; k < count; ++k) {
        int &lower = pieces[k].lower[d], &size = pieces[k].size[d];
        lower = size < n ? lower - floor_div(lower, n) * n : 0;
        size = std::min(size, n);
        if (lower + size <= n) continue;
        CellBox beyond = pieces[k];
        beyond.lower[d] = 0, beyond.size[d] = lower + size - n;
        size = n - lower;
        pieces.push_back(beyond);
      }
    }
    for (const CellBox& piece : pieces)
      if (piece.cells() > 0) boxes.push_back({piece, level});
    const CellBox next = lbm::grown(box, growth(spec_, level + 1));
    box = rounded(next.lower, next.lower + next.size, tile(level + 1));
  }
}

void FineBoxes::add_named(std::vector<LevelBox>& boxes) const {
  for (const rigid::BoundingBox& box : entrances_) add(around(box), 0, boxes);
  for (const auto& [box, level] : spec_.fine)
    add(rounded(floor_of(box.lower), ceil_of(box.upper), tile(level)), level, boxes);
}

bool FineBoxes::is_near(const CellBox& box, const CellBox& part) const {
  for (int d = 0; d < 3; ++d) {
    const int n = cells_[d];
    // distance of the box's lower end from that of the region that counts as near
    const int from = part.lower[d] - reach(), length = part.size[d] + 2 * reach(), gap = box.lower[d] - from;
    const bool meet = flow_.periodic(d) ? [&] {
      const int image = gap - floor_div(gap, n) * n;
      return image < length || image + box.size[d] > n;
    }() : gap < length && gap + box.size[d] > 0;
    if (!meet) return false;
  }
  return true;
}

/// Returns whether all cells of a box of tiles are finest; if only some are, appends their tiles.
bool FineBoxes::is_fine(const CellBox& tiles, const rigid::Shape& shape, const rigid::Pose& pose,
                        const CellBox& part, std::vector<LevelBox>& boxes) const {
  if (!is_near(tiles, part)) return false;
  const Vec3 half = 0.5 * Vec3(tiles.size.x, tiles.size.y, tiles.size.z);
  const Vec3 middle = Vec3(tiles.lower.x, tiles.lower.y, tiles.lower.z) + half;
  const double distance = distance_to(shape, pose.to_body(middle));
  if (distance > spec_.distance + half.norm()) return false;
  if (distance + half.norm() <= spec_.distance) return true;
  int axis = 0;
  for (int d = 1; d < 3; ++d)
    if (tiles.size[d] > tiles.size[axis]) axis = d;
  const int plane = plane_below(axis, tiles.lower[axis] + tiles.size[axis] / 2, wall_tile_);
  if (plane <= tiles.lower[axis]) return true;  // one tile
  CellBox lower = tiles, upper = tiles;
  lower.size[axis] = plane - tiles.lower[axis];
  upper.lower[axis] = plane, upper.size[axis] -= lower.size[axis];
  const bool low = is_fine(lower, shape, pose, part, boxes), high = is_fine(upper, shape, pose, part, boxes);
  if (low && high) return true;
  if (low) add(lower, 0, boxes);
  if (high) add(upper, 0, boxes);
  return false;
}

void FineBoxes::add_wall(const rigid::Shape& shape, const rigid::Pose& pose, const CellBox& part,
                         std::vector<LevelBox>& boxes) const {
  const auto* mesh = std::get_if<rigid::Mesh>(&shape);
  const rigid::BoundingBox extent =
      mesh ? rigid::Mesh{mesh->surface, false}.bounding_box(pose) : box_of(flow_);
  const Vec3 distance = Vec3::Constant(mesh ? spec_.distance : 0);
  const CellBox tiles =
      rounded(floor_of(extent.lower - distance), ceil_of(extent.upper + distance), wall_tile_);
  if (is_fine(tiles, shape, pose, part, boxes)) add(tiles, 0, boxes);
}

using lbm::CutTree;
using lbm::LevelCut;

namespace {

rigid::BoundingBox bounds(const CellBox& box) {
  const rigid::Vec3 lower(box.lower.x, box.lower.y, box.lower.z), size(box.size.x, box.size.y, box.size.z);
  return {lower, lower + size};
}

/// Returns the other ranks, sorted, whose parts are within a distance in cells of a part.
std::vector<int> ranks_within(int cells, const lbm::Domain& domain, const CellBox& part, int rank) {
  std::vector<int> ranks;
  Holders(domain, cells + 0.5).ranks_of(bounds(part), ranks);
  std::erase(ranks, rank);
  return ranks;
}

/// The longest way of a body, in cells, that regions allow for; bodies that are faster end the run anyway.
constexpr int furthest_ahead = 8;

/// Returns the pose of a body or wall, and where it moves, the one when the regions follow it next.
std::vector<rigid::Pose> poses_until_regrid(const rigid::BodySet& bodies, std::size_t row) {
  const rigid::Pose now = bodies.pose(row);
  const rigid::Vec3 v = bodies.velocity[row], w = bodies.angular_velocity[row];
  if (v.isZero(0) && w.isZero(0)) return {now};
  const double steps = regrid_interval, way = std::min(steps, furthest_ahead / std::max(v.norm(), 1e-9));
  return {now, {now.position + way * v, (rigid::cayley(steps * w) * now.orientation).normalized()}};
}

double largest_radius(const rigid::World& world) {
  double largest = 0;
  for (const double radius : world.bounding_radii)
    if (std::isfinite(radius)) largest = std::max(largest, radius);
  return largest;
}

}  // namespace

int coarsest_tile(const FlowSpec& flow) {
  return FineBoxes::tile(flow.coarsening->levels - 1);
}

Int3 tiles_of(const FlowSpec& flow) {
  Int3 tiles;
  for (int d = 0; d < 3; ++d) tiles[d] = std::max(1, flow.cells[d] / coarsest_tile(flow));
  return tiles;
}

CutTree of_cells(const CutTree& of_tiles, const FlowSpec& flow) {
  std::vector<lbm::Cut> nodes(of_tiles.nodes().begin(), of_tiles.nodes().end());
  for (lbm::Cut& cut : nodes) cut.position *= coarsest_tile(flow);
  return {{flow.cells[0], flow.cells[1], flow.cells[2]}, std::move(nodes)};
}

CutTree of_tiles(const CutTree& of_cells, const FlowSpec& flow) {
  std::vector<lbm::Cut> nodes(of_cells.nodes().begin(), of_cells.nodes().end());
  for (lbm::Cut& cut : nodes) cut.position /= coarsest_tile(flow);
  return {tiles_of(flow), std::move(nodes)};
}

CutTree cut_for_levels(const FlowSpec& flow, int ranks) {
  try {
    return of_cells(lbm::equal_cut(tiles_of(flow), ranks), flow);
  } catch (const std::invalid_argument&) {
    throw std::invalid_argument(
        fmt::format("the domain of {} x {} x {} cells cannot be cut into {} parts of at least {} cells an "
                    "edge, four of the coarsest; use fewer ranks, or fewer coarsening.levels",
                    flow.cells[0], flow.cells[1], flow.cells[2], ranks, 2 * coarsest_tile(flow)));
  }
}

LevelViews::LevelViews(const FlowSpec& flow, std::vector<rigid::BoundingBox> entrances, CutTree parts,
                       const rigid::World& world, MPI_Comm comm)
    : flow_(flow),
      fine_(flow, std::move(entrances)),
      world_(world),
      parts_(std::move(parts)),
      messages_(comm) {
  rank_ = parallel::rank_of(comm);
  part_ = parts_.leaf(rank_).box;
  const lbm::Domain domain(parts_, sides_of(flow), parts_.leaves());  // a leaf a rank
  beside_ = ranks_within(2 * coarsest_tile(flow), domain, part_, rank_);
  in_reach_ = ranks_within(int(std::ceil(largest_radius(world))) + furthest_ahead + fine_.reach(), domain,
                           part_, rank_);
  for (const int rank : in_reach_) parts_in_reach_.push_back(parts_.leaf(rank).box);
}

/// Returns the boxes that determine the levels of this rank's part.
std::vector<lbm::LevelBox> LevelViews::boxes_here(const rigid::BodySet& bodies) {
  std::vector<lbm::LevelBox> boxes;
  fine_.add_named(boxes);
  for (std::size_t row = bodies.first_wall(); row < bodies.size(); ++row)
    if (bodies.id[row] >= rigid::first_tube_id)
      for (const rigid::Pose& pose : poses_until_regrid(bodies, row))
        fine_.add_wall(world_.shapes[bodies.shape[row]], pose, part_, boxes);
  for (const int rank : in_reach_) messages_.to(rank);
  const auto add = [&](std::size_t row, const std::vector<rigid::Pose>& poses) {
    rigid::BoundingBox all = rigid::BoundingBox::empty();
    for (const rigid::Pose& pose : poses)
      all.add(rigid::bounding_box(world_.shapes[bodies.shape[row]], pose));
    const CellBox box = fine_.around(all);
    for (std::size_t k = 0; k < in_reach_.size(); ++k)
      if (fine_.is_near(box, parts_in_reach_[k])) parallel::put(messages_.to(in_reach_[k]), box);
    fine_.add(box, 0, boxes);
  };
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    const rigid::Pose pose = bodies.pose(row), mapped = mapping_pose(bodies, row);
    add(row, poses_until_regrid(bodies, row));
    if ((mapped.position - pose.position).norm() > least_margin(flow_.coupling))
      add(row, {mapped});  // the body has been moved since
  }
  messages_.exchange_with(in_reach_);
  messages_.for_received<CellBox>([&](const CellBox& box, int) { fine_.add(box, 0, boxes); });
  return boxes;
}

LevelCut LevelViews::cut_from(const parallel::Bytes& bytes) const {
  parallel::ByteReader reader(bytes);
  LevelCut cut;
  cut.levels.resize(reader.read<std::int32_t>());
  cut.nodes.resize(cut.levels.size() - 1);
  reader.read(std::span(cut.nodes));
  reader.read(std::span(cut.levels));
  return cut;
}

CutTree LevelViews::view(std::span<const lbm::LevelBox> boxes) {
  std::map<int, LevelCut> cuts;
  const LevelCut& mine = cuts[rank_] = level_cut(part_, boxes, flow_.coarsening->levels);
  for (const int rank : beside_) {
    parallel::Bytes& to = messages_.to(rank);
    parallel::put(to, std::int32_t(mine.levels.size()));
    parallel::put(to, std::span(mine.nodes));
    parallel::put(to, std::span(mine.levels));
  }
  messages_.exchange_with(beside_);
  for (const parallel::Messages::Message& m : messages_.received()) cuts[m.rank] = cut_from(m.bytes);
  return view_of(parts_, cuts);
}

}  // namespace silt::coupler

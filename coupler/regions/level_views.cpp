#include "coupler/regions/level_views.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/exchange/holders.hpp"
#include "lbm/blocks/equal_cut.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

using lbm::CellBox;
using lbm::CutTree;
using lbm::Int3;
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

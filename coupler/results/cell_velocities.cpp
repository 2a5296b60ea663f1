#include "coupler/results/cell_velocities.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "lbm/fluid.hpp"
#include "parallel/messages.hpp"

namespace silt::coupler {

using lbm::CellBox;
using lbm::Int3;
using rigid::Vec3;

namespace {

/// The blocks that have a cell within reach of a box.
std::vector<lbm::BlockPlace> blocks_near(const lbm::Domain& domain, const CellBox& box) {
  std::array<lbm::CellRun, 3> runs;
  for (int d = 0; d < 3; ++d) {
    constexpr int reach = CellVelocities::reach;
    const int n = domain.cells()[d];
    const int low = box.lower[d] - reach, high = box.lower[d] + box.size[d] + reach;
    if (domain.periodic(d))
      runs[d] = {(low + n) % n, std::min(high - low, n)};
    else
      runs[d] = {std::max(low, 0), std::min(high, n) - std::max(low, 0)};
  }
  std::set<int> found;
  domain.for_blocks_meeting(runs, [&](const lbm::BlockPlace& place) { found.insert(place.index); });
  std::vector<lbm::BlockPlace> places;
  for (const int b : found) places.push_back(domain.block(b));
  return places;
}

}  // namespace

CellVelocities::CellVelocities(const Flow& flow, MPI_Comm comm, Int3 lower, Int3 upper)
    : flow_(flow), lower_(lower), upper_(upper) {
  rank_ = parallel::rank_of(comm);
  if (flow.domain().ranks() == 1) return;
  parallel::Messages messages(comm);
  send(messages);
  messages.unannounced();
  for (const parallel::Messages::Message& message : messages.received())
    for (parallel::ByteReader reader(message.bytes); !reader.done();)
      from_others_.push_back(reader.take<Known>());
  std::sort(from_others_.begin(), from_others_.end(),
            [](const Known& a, const Known& b) { return a.cell < b.cell; });
}

/// What a block has of the box; may be empty.
CellBox CellVelocities::in_box(const CellBox& block) const {
  CellBox part;
  for (int d = 0; d < 3; ++d) {
    part.lower[d] = std::max(block.lower[d], lower_[d]);
    part.size[d] = std::max(0, std::min(block.lower[d] + block.size[d], upper_[d]) - part.lower[d]);
  }
  return part;
}

/// Visits the cells of the domain within reach of the faces of a box, along the axes, where they are.
template <class Visit>
void CellVelocities::for_cells_around(const CellBox& box, Visit&& visit) const {
  if (box.cells() == 0) return;
  const lbm::Domain& domain = flow_.domain();
  for (int d = 0; d < 3; ++d)
    for (int away = 1; away <= reach; ++away)
      for (const int at : {box.lower[d] - away, box.lower[d] + box.size[d] - 1 + away}) {
        CellBox layer = box;
        layer.lower[d] = at, layer.size[d] = 1;
        for (int z = 0; z < layer.size.z; ++z)
          for (int y = 0; y < layer.size.y; ++y)
            for (int x = 0; x < layer.size.x; ++x) {
              const Int3 cell = domain.wrapped(layer.lower + Int3{x, y, z});
              if (domain.inside(cell)) visit(cell);
            }
      }
}

/// To each rank what it has to know of this one's cells, each cell once.
void CellVelocities::send(parallel::Messages& messages) const {
  const lbm::Domain& domain = flow_.domain();
  std::set<std::pair<int, std::int64_t>> sent;
  for (int b = 0; b < flow_.blocks(); ++b) {
    const CellBox& box = flow_.block(b);
    for (const lbm::BlockPlace& place : blocks_near(domain, box)) {
      if (place.rank == rank_) continue;
      for_cells_around(in_box(place.box), [&](Int3 cell) {
        if (!box.contains(cell) || !sent.insert({place.rank, index(cell)}).second) return;
        const auto u = here(b, cell - box.lower);
        const Vec3 v = u.value_or(Vec3::Zero());
        parallel::put(messages.to(place.rank), Known{index(cell), u.has_value(), {v[0], v[1], v[2]}});
      });
    }
  }
}

std::int64_t CellVelocities::index(Int3 cell) const {
  const Int3 n = flow_.domain().cells();
  return (std::int64_t(cell.z) * n.y + cell.y) * n.x + cell.x;
}

std::optional<Vec3> CellVelocities::here(int block, Int3 local_cell) const {
  if (!flow_.is_fluid(block, local_cell)) return std::nullopt;
  const auto u = flow_.velocity(flow_.moments(block, local_cell));
  return Vec3(u[0], u[1], u[2]);
}

std::optional<Vec3> CellVelocities::at(int block, Int3 local_cell) const {
  const CellBox& box = flow_.block(block);
  const lbm::Domain& domain = flow_.domain();
  const Int3 cell = domain.wrapped(box.lower + local_cell);
  if (box.contains(cell)) return here(block, cell - box.lower);
  if (!domain.inside(cell)) return std::nullopt;
  const lbm::BlockPlace place = domain.block_at(cell);
  if (place.rank == rank_) return here(domain.local_index(place, rank_), cell - place.box.lower);
  const auto known = std::lower_bound(from_others_.begin(), from_others_.end(), index(cell),
                                      [](const Known& k, std::int64_t i) { return k.cell < i; });
  if (known == from_others_.end() || known->cell != index(cell))
    throw std::logic_error("the velocity of a cell was not asked for");
  if (!known->is_fluid) return std::nullopt;
  return Vec3(known->velocity[0], known->velocity[1], known->velocity[2]);
}

}  // namespace silt::coupler

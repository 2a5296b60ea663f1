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

CellBox overlap(const CellBox& a, const CellBox& b) {
  CellBox part;
  for (int d = 0; d < 3; ++d) {
    part.lower[d] = std::max(a.lower[d], b.lower[d]);
    part.size[d] = std::max(0, std::min(a.lower[d] + a.size[d], b.lower[d] + b.size[d]) - part.lower[d]);
  }
  return part;
}

}  // namespace

CellVelocities::CellVelocities(const FluidFields& fields, MPI_Comm comm, Int3 lower, Int3 upper)
    : fields_(fields), box_{lower, upper - lower} {
  rank_ = parallel::rank_of(comm);
  parallel::Messages messages(comm);
  for (int b = 0; b < fields.blocks(); ++b)
    for (const lbm::BlockPlace& place : blocks_near(fields.domain(), fields.block(b)))
      tell(b, place, messages);
  messages.unannounced();
  for (const parallel::Messages::Message& message : messages.received())
    for (parallel::ByteReader reader(message.bytes); !reader.done();) known_.push_back(reader.take<Known>());
  std::sort(known_.begin(), known_.end(), [](const Known& a, const Known& b) { return a.cell < b.cell; });
}

/// Tells the rank of a block, which may be this one, the cells here within reach of the faces of what that
/// block has of the box, along the axes.
void CellVelocities::tell(int block, const lbm::BlockPlace& to, parallel::Messages& messages) {
  const lbm::Domain& domain = fields_.domain();
  const CellBox there = overlap(to.box, box_);
  if (there.cells() == 0) return;
  lbm::MomentArrays moments;
  for (int d = 0; d < 3; ++d)
    for (int away = 1; away <= reach; ++away)
      for (const int at : {there.lower[d] - away, there.lower[d] + there.size[d] - 1 + away}) {
        CellBox layer = there;
        layer.lower[d] = at, layer.size[d] = 1;
        layer.lower = domain.wrapped(layer.lower);
        const CellBox here = overlap(layer, fields_.block(block));
        if (here.cells() == 0) continue;
        const Int3 first = here.lower - fields_.block(block).lower;
        fields_.moments(block, {first, here.size}, moments);
        std::int64_t n = 0;
        for_cells(first, first + here.size, [&](Int3 cell) {
          const auto u = fields_.velocity(moments[n++]);
          const Known known{
              index(fields_.block(block).lower + cell), fields_.is_fluid(block, cell), {u[0], u[1], u[2]}};
          if (to.rank == rank_)
            known_.push_back(known);
          else
            parallel::put(messages.to(to.rank), known);
        });
      }
}

std::int64_t CellVelocities::index(Int3 cell) const {
  const Int3 n = fields_.domain().cells();
  return (std::int64_t(cell.z) * n.y + cell.y) * n.x + cell.x;
}

std::optional<Vec3> CellVelocities::at(int block, Int3 local_cell) const {
  const lbm::Domain& domain = fields_.domain();
  const Int3 cell = domain.wrapped(fields_.block(block).lower + local_cell);
  if (!domain.inside(cell)) return std::nullopt;
  const auto known = std::lower_bound(known_.begin(), known_.end(), index(cell),
                                      [](const Known& k, std::int64_t i) { return k.cell < i; });
  if (known == known_.end() || known->cell != index(cell))
    throw std::logic_error("the velocity of a cell was not asked for");
  if (!known->is_fluid) return std::nullopt;
  return Vec3(known->velocity[0], known->velocity[1], known->velocity[2]);
}

}  // namespace silt::coupler

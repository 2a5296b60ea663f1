#include "coupler/balance/level_work.hpp"

#include <array>

namespace silt::coupler {

namespace {
/// What a coarse cell at a face across each axis takes in each of the two fine steps, in updates of fine
/// cells: fifty regions of 28 cells an edge, one core.
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

}  // namespace silt::coupler

#include "silt/load_balance.hpp"

#include "coupler/balance/body_work.hpp"
#include "silt/case/case.hpp"
#include "silt/scene.hpp"

namespace silt {
namespace {

/// The cost of a move in steps of mean work: populations are sent, halo and maps rebuilt.
constexpr double steps_of_a_move = 20;

/// Returns the work of cells beyond that of the coarsest cells in their place, and the given items, in tiles,
/// by which a domain with several levels is cut.
std::vector<coupler::WorkItem> in_tiles(const Scene& scene, std::int64_t work_of_a_cell,
                                        std::vector<coupler::WorkItem> items) {
  const int tile = coarsest_tile(scene.setup), levels = scene.setup.coarsening->levels;
  const lbm::Int3 tiles = tiles_of(scene.setup);
  const lbm::Domain view = scene.level_view();
  for (int leaf = 0; leaf < view.blocks(); ++leaf) {
    const lbm::LeafKind& kind = view.tree().kinds()[leaf];
    if (kind.rank != scene.rank() || kind.level == levels) continue;
    const lbm::CellBox box = view.tree().leaf(leaf).box;
    const std::int64_t of_coarsest = (work_of_a_cell * box.cells()) >> 4 * levels;
    items.push_back({box, coupler::work_of_leaf(view, leaf, work_of_a_cell) - of_coarsest});
  }
  for (coupler::WorkItem& item : items)
    for (int d = 0; d < 3; ++d) {
      const int last = std::min((item.box.lower[d] + item.box.size[d] - 1) / tile, tiles[d] - 1);
      item.box.lower[d] = std::min(item.box.lower[d] / tile, last);
      item.box.size[d] = last + 1 - item.box.lower[d];
    }
  return items;
}

}  // namespace

bool CutComparison::worth_moving(std::int64_t steps) const {
  return (present.largest - better.largest) * double(steps) > steps_of_a_move * present.mean;
}

CutComparison compare_cuts(const Scene& scene) {
  const coupler::WorkCosts costs(scene.setup, scene.setup.contacts.substeps);
  coupler::WorkMap work(scene.domain);
  add_bodies(scene.bodies, costs, work);
  if (scene.flow)
    for (const coupler::BlockMap& map : scene.flow->fields().maps())
      add_mapped(map, scene.bodies, scene.world, costs, work);
  else
    add_surfaces(scene.bodies, scene.world, costs, work);
  auto items = work.items();
  lbm::Domain domain = scene.domain;
  std::int64_t work_of_a_cell = costs.cell;
  int edge = lbm::usual_edge;
  if (scene.setup.coarsening) {
    items = in_tiles(scene, costs.cell, std::move(items));
    domain = lbm::Domain(of_tiles(domain.tree(), scene.setup), domain.sides(), domain.ranks());
    const std::int64_t tile = coarsest_tile(scene.setup);
    edge = std::max(2, int(edge / tile));
    work_of_a_cell = (costs.cell * tile * tile * tile) >> 4 * scene.setup.coarsening->levels;
  }
  coupler::WeightedCut present = present_cut(scene.comm, domain, work_of_a_cell, items);
  coupler::WeightedCut better =
      weighted_cut(scene.comm, domain.cells(), work_of_a_cell, std::move(items), edge);
  if (scene.setup.coarsening) better.tree = of_cells(better.tree, scene.setup);
  return {std::move(present), std::move(better)};
}

}  // namespace silt

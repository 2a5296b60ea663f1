#include "coupler/load_balance.hpp"

#include "coupler/balance/body_work.hpp"
#include "coupler/case/case.hpp"
#include "coupler/scene.hpp"

namespace silt::coupler {

namespace {
/// A move takes as long as so many steps of mean work: populations go, halo and maps are made anew.
constexpr double steps_of_a_move = 20;
}  // namespace

bool CutComparison::worth_moving(std::int64_t steps) const {
  return (present.largest - better.largest) * double(steps) > steps_of_a_move * present.mean;
}

CutComparison compare_cuts(const Scene& scene) {
  const WorkCosts costs(scene.setup);
  WorkMap work(scene.domain);
  add_bodies(scene.bodies, costs, work);
  if (scene.flow)
    for (const BlockMap& map : scene.flow->fields().maps())
      add_mapped(map, scene.bodies, scene.world, costs, work);
  else
    add_surfaces(scene.bodies, scene.world, costs, work);
  auto items = work.items();
  WeightedCut present = present_cut(scene.comm, scene.domain, costs.cell, items);
  return {std::move(present), weighted_cut(scene.comm, scene.domain.cells(), costs.cell, std::move(items))};
}

}  // namespace silt::coupler

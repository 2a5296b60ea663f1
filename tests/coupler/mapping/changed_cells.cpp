// Cells that change sides are found, each once, whoever had them.
#include <array>
#include <set>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/mapping/map_bodies.hpp"
#include "coupler/mapping/refill.hpp"
#include "coupler/simulation.hpp"
#include "tests/coupler/coupled_scenes.hpp"

namespace silt::coupler::testing {
namespace {

using CellOfBlock = std::array<int, 4>;

std::set<CellOfBlock> cells_in(const std::vector<CoveredCell>& listed) {
  std::set<CellOfBlock> cells;
  for (const CoveredCell& c : listed)
    EXPECT_TRUE(cells.insert({c.block, c.cell.x, c.cell.y, c.cell.z}).second) << "listed twice";
  return cells;
}

/// Two balls that pass one another and share cells on the way, through the sides of a periodic domain.
TEST(ChangedCells, AreThoseOfTheMaps) {
  CaseText c;
  c.domain = domain_of({70, 20, 18}, R"({ x = "periodic", y = "periodic", z = ["no-slip", "no-slip"] })");
  c.shapes = sphere_of("ball", 6.6);
  c.bodies = body_of("ball", 1, "positions = [[20, 6, 8], [30, 6, 8]]");
  Simulation s = c.start(MPI_COMM_SELF, {"domain.blocks=[35, 20, 18]"});
  const lbm::Domain& domain = s.scene().flow->fields().domain();
  std::vector<lbm::CellBox> boxes;
  for (const auto& place : domain.blocks_of(0)) boxes.push_back(place.box);
  MapBodies map(domain, s.scene().world, boxes, 2);
  map(s.bodies());
  std::size_t covered = 0, uncovered = 0;
  for (int step = 1; step < 120; ++step) {
    for (std::size_t row = 0; row < 2; ++row) {
      const double way = (row ? -0.27 : 0.31) * step;
      const auto within = [](double x, double n) { return x - n * std::floor(x / n); };
      const rigid::Vec3 x(within((row ? 30 : 20) + 2 * way, 70), within(6 + 1.7 * way, 20), 8 + row);
      set_mapping_pose(s.bodies(), row, {x, mapping_pose(s.bodies(), row).orientation});
    }
    map(s.bodies());
    const ChangedCells changed = changed_cells(map.blocks());
    std::set<CellOfBlock> now_solid, now_fluid;
    for (int b = 0; b < int(boxes.size()); ++b) {
      const BlockMap& block = map.blocks()[b];
      for_cells({}, block.box.size, [&](lbm::Int3 x) {
        if (block.solid.test(x) && !block.before.test(x)) now_solid.insert({b, x.x, x.y, x.z});
        if (!block.solid.test(x) && block.before.test(x)) now_fluid.insert({b, x.x, x.y, x.z});
      });
    }
    EXPECT_EQ(cells_in(changed.covered), now_solid) << step;
    EXPECT_EQ(cells_in(changed.uncovered), now_fluid) << step;
    covered += now_solid.size(), uncovered += now_fluid.size();
  }
  EXPECT_GT(covered, 1000u);
  EXPECT_GT(uncovered, 1000u);
}

}  // namespace
}  // namespace silt::coupler::testing

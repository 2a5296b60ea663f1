// What a link in a gap of one cell is told of the wall on the other side.
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <tuple>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/mapping/block_links.hpp"
#include "coupler/mapping/build_links.hpp"
#include "coupler/mapping/map_bodies.hpp"
#include "coupler/simulation.hpp"
#include "rigid/shapes/shape.hpp"
#include "tests/coupler/coupled_scenes.hpp"

namespace silt::coupler::testing {
namespace {

using lbm::Int3;
using rigid::Vec3;

/// Where a link is, its surface, the places of its far wall (those that fill up its group too).
template <class T>
struct GapLink {
  std::size_t surface;
  T q;
  std::vector<std::uint32_t> far;
};

template <class T>
std::map<std::array<int, 4>, GapLink<T>> gap_links(const std::vector<SurfaceLinks<T>>& surfaces) {
  std::map<std::array<int, 4>, GapLink<T>> found;
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    const auto& links = surfaces[k].links;
    for (const lbm::LinkGroup& g : links.groups)
      for (std::uint32_t l = 0;
           g.scheme == WallScheme::single_cell_gap && (l < g.count || l % lbm::link_lanes); ++l) {
        const std::uint32_t p = links.place[g.begin + l];
        const Int3 x = g.corner + lbm::place_cell(p);
        auto& link = found[{x.x, x.y, x.z, lbm::place_direction(p)}];
        link.surface = k, link.q = links.q[g.begin + l], link.far.push_back(g.opposite + l);
      }
  }
  return found;
}

/// The crowd between walls that move, flow in at y low and slip at z high.
Simulation crowd_between_sides() {
  return crowd().start(MPI_COMM_SELF,
                       {"domain.boundary.y=[{type='velocity-inlet',velocity=[0.01,0.02,-0.03]},'no-slip']",
                        "domain.boundary.z=[{type='moving',velocity=[0.04,-0.05,0]},'free-slip']"});
}

/// Lets a box nearly fill an edge of the domain, another one lie just below the side that slips.
void put_boxes_at_sides(Simulation& s) {
  constexpr double gap = 0.8;  // the cells next to the side are fluid, those behind them solid
  const Vec3 places[] = {{12, gap + 3, gap + 2}, {5, 10, 28 - gap - 2}};
  for (std::size_t row = 0, found = 0; row < s.bodies().first_wall() && found < 2; ++row)
    if (std::holds_alternative<rigid::Box>(s.scene().world.shapes[s.bodies().shape[row]]))
      set_mapping_pose(s.bodies(), row, {places[found++], rigid::Quat::Identity()});
}

/// The wall that a link along c has behind its cell, beyond the sides of n cells.
struct Side {
  double q = 0, u = 0;  // 0: there is none, it slips
  bool edge = false;
};
Side side_behind(Int3 behind, Int3 n, Int3 c) {
  const bool floor = behind.z < 0, low = behind.y < 0, high = behind.y >= n.y;
  if (floor && low) return {0.5, c.y * 0.02, true};  // of both walls what crosses them
  if (floor && high) return {0.5, 0, true};
  if (floor) return {0.5, c.x * 0.04 - c.y * 0.05};
  if (low) return {0.5, c.x * 0.01 + c.y * 0.02 - c.z * 0.03};
  return {high ? 0.5 : 0};
}

TEST(GapLinks, KnowTheWallOnTheOtherSide) {
  Simulation s = crowd_between_sides();
  put_boxes_at_sides(s);
  const Int3 n = s.scene().flow->fields().domain().cells();
  MapBodies map(s.scene().flow->fields().domain(), s.scene().world, std::vector<lbm::CellBox>{{{}, n}}, 1);
  map(s.bodies());
  BlockLinks<double> block;
  auto& surfaces = block.surfaces;
  CouplingSpec coupling;
  coupling.wall_scheme = WallScheme::parabolic;
  build_links<double>(map.blocks()[0], s.scene().world, s.bodies(),
                      {coupling, {}, lbm::PassOrder(map.blocks()[0].box.size, sizeof(double))}, surfaces);
  for (std::size_t k = 0; k < surfaces.size(); ++k)
    surfaces[k].motion = {{0.1 * double(k), 0.2, -0.3}, {0.4, -0.5, 0.6 * double(k)}};
  block.gaps.pair(surfaces, s.scene().flow->fields().domain(), {{}, n});
  block.gaps.set_velocities(surfaces);
  const auto all = gap_links(surfaces);
  int between = 0, sides = 0, edges = 0, slipping = 0;
  for (const auto& [at, link] : all) {
    const auto other = all.find({at[0], at[1], at[2], lbm::opposite(at[3])});
    const auto& links = surfaces[link.surface].links;
    const Int3 c = lbm::c[at[3]];
    if (other == all.end()) {
      const Int3 behind{at[0] - c.x, at[1] - c.y, at[2] - c.z};
      EXPECT_FALSE(s.scene().flow->fields().domain().inside(behind)) << "a gap whose other wall is not known";
      const Side side = side_behind(behind, n, c);
      for (const std::uint32_t far : link.far) {
        EXPECT_EQ(links.opposite_q[far], side.q);
        EXPECT_NEAR(links.opposite_u[far], side.u, 1e-15);
      }
      ++(side.edge ? edges : side.q > 0 ? sides : slipping);
      continue;
    }
    between += other->second.surface != link.surface;
    const auto& [frame, motion] =
        std::tie(surfaces[other->second.surface].links.frame, surfaces[other->second.surface].motion);
    Vec3 arm, v(motion.v[0], motion.v[1], motion.v[2]), w(motion.omega[0], motion.omega[1], motion.omega[2]);
    for (int d = 0; d < 3; ++d) arm[d] = at[d] - frame.cell[d] + frame.offset[d];
    for (const std::uint32_t far : link.far) {
      EXPECT_EQ(links.opposite_q[far], other->second.q);
      EXPECT_NEAR(links.opposite_u[far], Vec3(c.x, c.y, c.z).dot(v + w.cross(arm)), 1e-12);
    }
  }
  EXPECT_GT(between, 0);
  EXPECT_GT(sides, 0);
  EXPECT_GT(edges, 0);
  EXPECT_GT(slipping, 0);
}

}  // namespace
}  // namespace silt::coupler::testing

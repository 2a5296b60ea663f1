// The links of a block are those of the definition, of bodies of every shape and in gaps of one cell, where
// links are told of the wall on the other side.
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <string>
#include <tuple>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/mapping/block_links.hpp"
#include "coupler/mapping/build_links.hpp"
#include "coupler/mapping/map_bodies.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/simulation.hpp"
#include "tests/coupler/mapping/links_by_definition.hpp"
#include "tests/coupler/single_cells.hpp"
#include "tests/shape_rows.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/silt/coupled_scenes.hpp"

namespace silt::coupler::testing {
namespace {

using lbm::Int3;
using rigid::Vec3;

/// Shows the body to the fluid somewhere else.
void move(rigid::BodySet& bodies, std::size_t row, const Vec3& to) {
  set_mapping_pose(bodies, row, {to, mapping_pose(bodies, row).orientation});
}

/// The crowd after some steps, in blocks of several sizes, and then again with some of the bodies moved.
template <class T>
void check_crowd(const char* blocks, WallScheme scheme, double rounding, Device device = Device::cpu) {
  Simulation s = crowd().start(MPI_COMM_SELF, {blocks});
  for (rigid::BodyId id = 1; id <= s.scene().at_start.body_count; ++id)
    s.set_velocity(id, 0.05 * Vec3(std::cos(1.7 * id), std::sin(1.7 * id), std::sin(3.4 * id)),
                   0.01 * Vec3(std::sin(1.7 * id), 0.3, -0.5));
  for (int t = 0; t < 80; ++t) s.step();
  const lbm::Domain& domain = s.scene().flow->fields().domain();
  std::vector<lbm::CellBox> boxes;
  for (const auto& place : domain.blocks_of(0)) boxes.push_back(place.box);
  MapBodies map(domain, s.scene().world, boxes, lbm::link_reach(scheme));
  std::vector<std::vector<SurfaceLinks<T>>> surfaces(boxes.size());
  std::vector<DeviceMapping<T>> on_device;
  for (std::size_t b = 0; device != Device::cpu && b < boxes.size(); ++b) on_device.emplace_back(device);
  LinkKinds kinds;
  int kept = 0, spoilt = 0;  // spoilt: bodies at rest whose links others changed
  for (unsigned round = 0; round < 3; ++round) {
    map(s.bodies());
    for (std::size_t b = 0; b < boxes.size(); ++b)
      expect_all_links<T>(s, map.blocks()[b], scheme, rounding, surfaces[b], kinds,
                          on_device.empty() ? nullptr : &on_device[b]);
    for (const BlockMap& block : map.blocks())
      for (const BodyMask& mask : block.masks)
        (mask.kept ? kept : spoilt) += block.changed && round > 0 && mask.id % 4 != round;
    for (std::size_t row = 0; row < s.bodies().first_wall(); ++row)
      if (s.bodies().id[row] % 4 == round + 1)
        move(s.bodies(), row, mapping_pose(s.bodies(), row).position + Vec3(0.3, -0.4, 0.2));
  }
  EXPECT_EQ(kinds.single_cell > 0, scheme != WallScheme::bounce_back);
  EXPECT_EQ(kinds.two_cells > 0, scheme == WallScheme::multireflection);
  EXPECT_EQ(kinds.across > 0, scheme == WallScheme::multireflection);
  EXPECT_EQ(kinds.crossing > 0, scheme != WallScheme::bounce_back);
  EXPECT_GT(kinds.reflected, 0);
  EXPECT_GT(kept, 0);
  EXPECT_GT(spoilt, 0);
}

TEST(Links, AreThoseOfTheDefinition) {
  check_crowd<double>("domain.blocks=[24,20,28]", WallScheme::cli, 1e-9);
  check_crowd<float>("domain.blocks=[12,10,14]", WallScheme::cli, 2e-4);
  check_crowd<float>("domain.blocks=[12,5,28]", WallScheme::bounce_back, 0);
  check_crowd<double>("domain.blocks=[7,9,5]", WallScheme::parabolic, 1e-9);
}

TEST(Links, ThatADeviceListsAreThoseOfTheDefinition) {
  for (const Device device : {Device::host, Device::gpu}) {
    if (!unusable(device).empty()) continue;
    check_crowd<float>("domain.blocks=[24,20,28]", WallScheme::cli, 2e-4, device);
    check_crowd<float>("domain.blocks=[12,5,28]", WallScheme::bounce_back, 0, device);
    check_crowd<double>("domain.blocks=[12,10,14]", WallScheme::multireflection, 1e-9, device);
  }
}

TEST(Links, ThatReadBeyondAreThoseOfTheDefinition) {
  check_crowd<double>("domain.blocks=[24,20,28]", WallScheme::multireflection, 1e-9);
  check_crowd<double>("domain.blocks=[7,9,5]", WallScheme::multireflection, 1e-9);
  check_crowd<float>("domain.blocks=[12,10,14]", WallScheme::multireflection, 2e-4);
  check_crowd<float>("domain.blocks=[2,20,4]", WallScheme::multireflection, 2e-4);
}

/// A ball that comes to rest at mapping poses of our choice, and a smaller one of a lower id.
CaseText visited_ball() {
  CaseText c;
  c.domain = domain_of({18, 18, 18});
  c.shapes = sphere_of("visitor", 3.3) + sphere_of("ball", 5.4);
  c.bodies = body_of("visitor", 1, "position = [2.5, 2.5, 2.5]") +
             body_of("ball", 1, "position = [9.0312, 8.9371, 9.0523]");
  return c;
}

/// The visitor comes from within, where it takes of the ball's cells without a change of what is solid, to
/// where it is out of reach of its links.
void check_visits(WallScheme scheme, Device device = Device::cpu) {
  Simulation s = visited_ball().start(MPI_COMM_SELF);
  MapBodies map(s.scene().flow->fields().domain(), s.scene().world,
                std::vector<lbm::CellBox>{{{}, {18, 18, 18}}}, lbm::link_reach(scheme));
  std::vector<SurfaceLinks<double>> surfaces;
  DeviceMapping<double> on_device(device);
  LinkKinds kinds;
  int kept = 0, renewed = 0;
  const Vec3 centre = mapping_pose(s.bodies(), 1).position;
  for (int i = 1; i < lbm::D3Q19::directions; ++i)
    for (double distance = 1.05; distance < 9; distance += 0.55) {
      const Vec3 along = Vec3(lbm::D3Q19::c[i].x, lbm::D3Q19::c[i].y, lbm::D3Q19::c[i].z).normalized();
      move(s.bodies(), 0, centre + distance * along);
      map(s.bodies());
      expect_all_links<double>(s, map.blocks()[0], scheme, 1e-9, surfaces, kinds,
                               device == Device::cpu ? nullptr : &on_device);
      ++(map.blocks()[0].masks.back().kept ? kept : renewed);
    }
  EXPECT_GT(kept, 10);
  EXPECT_GT(renewed, 10);
}

TEST(Links, OfABodyAtRestFollowWhatVisitsItsCells) {
  check_visits(WallScheme::cli);
  check_visits(WallScheme::multireflection);
  for (const Device device : {Device::host, Device::gpu})
    if (unusable(device).empty()) check_visits(WallScheme::multireflection, device);
}

// Wider than a word, taller than a slab of planes.
CaseText large_bodies() {
  CaseText c;
  c.domain = domain_of({96, 40, 44});
  c.shapes = shape_of("egg", "ellipsoid", "diameters = [74.6, 24.8, 34.4]") + sphere_of("ball", 34.6);
  c.bodies =
      body_of("egg", 1, "position = [41.2173, 20.4291, 22.1357]\norientation = [0.98, 0.05, 0.1, 0.02]") +
      body_of("ball", 1, "position = [90.1371, 3.2713, 1.3197]");
  return c;
}

/// One body of every shape, oblique and in line with the axes, across the sides of the box.
CaseText one_of_each() {
  CaseText c;
  c.domain = domain_of({45, 30, 26});
  c.shapes = c.bodies = "";
  std::vector<std::array<std::string, 2>> shapes;
  for (const tests::ShapeRow& row : tests::shape_rows()) {
    if (row.name == rigid::Sphere::name) continue;  // spheres have tests of their own
    shapes.push_back({std::string(row.name), row.sizes});
  }
  shapes.push_back({"compound",
                    "parts = [ { type = \"capsule\", radius = 1.6, length = 6, orientation = [1, 0, 0] },\n"
                    "{ type = \"capsule\", radius = 1.6, length = 6, orientation = [0, 1, 0] },\n"
                    "{ type = \"capsule\", radius = 1.6, length = 6, orientation = [0, 0, 1] } ]"});
  shapes.push_back(
      {"compound",
       "parts = [ { type = \"sphere\", radius = 2.2, position = [3, 1, 0] },\n"
       "{ type = \"box\", edges = [4, 3, 2.5], position = [-2, 0, 1], orientation = [1, 2, 3] },\n"
       "{ type = \"cylinder\", radius = 1.1, length = 7, orientation = [0, 1, 1] },\n"
       "{ type = \"ellipsoid\", diameters = [3, 4, 5], position = [0, -2, -1] },\n"
       "{ type = \"polyhedron\", position = [0, 1, 1], " +
           tests::row_of("polyhedron").sizes + " } ]"});
  int n = 0;
  for (const auto& [type, sizes] : shapes) {
    const std::string name = type + std::to_string(n / 2);
    c.shapes += shape_of(name, type, sizes);
    for (const char* turn : {"[1, 0, 0, 0]", "[0.7, 0.3, -0.5, 0.2]"}) {
      const auto at = [](int slot, int slots, double size, double shift) {
        return std::to_string(std::fmod((slot + shift) * size / slots, size));
      };
      c.bodies +=
          body_of(name, 1,
                  std::string("orientation = ") + turn + "\nposition = [" +
                      at(n % 4, 4, 45, 0.93 + 0.0041 * n) + ", " + at(n / 4 % 2, 2, 30, 0.9173 + 0.0031 * n) +
                      ", " + at(n / 8, 2, 26, 0.0341 + 0.0017 * n) + "]");
      ++n;
    }
  }
  return c;
}

/// Every q of the domain, by global cell and direction.
using Distances = std::map<std::tuple<int, int, int, int>, double>;

template <class T>
Distances distances(const CaseText& scene, Int3 block, double rounding) {
  Simulation s = scene.start(MPI_COMM_SELF);
  std::vector<lbm::CellBox> boxes;
  const Int3 n = s.scene().flow->fields().domain().cells();
  for (int z = 0; z < n.z; z += block.z)
    for (int y = 0; y < n.y; y += block.y)
      for (int x = 0; x < n.x; x += block.x) boxes.push_back({{x, y, z}, block});
  MapBodies map(s.scene().flow->fields().domain(), s.scene().world, boxes, 1);
  map(s.bodies());
  Distances all;
  LinkKinds kinds;
  for (const BlockMap& b : map.blocks()) {
    std::vector<SurfaceLinks<T>> surfaces;
    expect_all_links<T>(s, b, WallScheme::cli, rounding, surfaces, kinds);
    for (const auto& surface : surfaces)
      for (const lbm::LinkGroup& g : surface.links.groups)
        for (std::uint32_t l = g.begin; l < g.begin + g.count; ++l) {
          const std::uint32_t p = surface.links.place[l];
          const Int3 x = b.box.lower + g.corner + lbm::place_cell(p);
          all[{x.x, x.y, x.z, lbm::place_direction(p)}] = surface.links.q[l];
        }
  }
  return all;
}

/// Root of the mean square of what single precision takes away. For one link it is up to 1e-7 R^2 over its
/// way through the body: much where it grazes the surface.
void expect_close(const Distances& single, const Distances& exact, double bound) {
  EXPECT_EQ(single.size(), exact.size());
  double squares = 0;
  for (const auto& [link, q] : exact) squares += std::pow(single.at(link) - q, 2);
  EXPECT_LT(std::sqrt(squares / double(exact.size())), bound);
}

TEST(LinksOfShapes, OfEveryKind) {
  const CaseText scene = one_of_each();
  const Distances whole = distances<double>(scene, {45, 30, 26}, 1e-9);
  EXPECT_EQ(whole, distances<double>(scene, {15, 10, 13}, 1e-9));
  const Distances single = distances<float>(scene, {15, 15, 13}, 3e-5);
  EXPECT_EQ(single, distances<float>(scene, {9, 10, 26}, 3e-5));
  expect_close(single, whole, 1e-6);
}

TEST(LinksOfShapes, LargerThanAWord) {
  const Distances exact = distances<double>(large_bodies(), {96, 40, 44}, 1e-9);
  expect_close(distances<float>(large_bodies(), {96, 40, 44}, 5e-4), exact, 4e-6);
}

/// A link: its surface, its distance, the place of its far wall.
template <class T>
struct GapLink {
  std::size_t surface;
  T q;
  std::uint32_t far;
};

template <class T>
std::map<std::array<int, 4>, GapLink<T>> gap_links(const std::vector<SurfaceLinks<T>>& surfaces) {
  std::map<std::array<int, 4>, GapLink<T>> found;
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    const auto& links = surfaces[k].links;
    for (const lbm::LinkGroup& g : links.groups)
      for (std::uint32_t l = 0; g.scheme == WallScheme::single_cell_gap && l < g.count; ++l) {
        const std::uint32_t p = links.place[g.begin + l];
        const Int3 x = g.corner + lbm::place_cell(p);
        found[{x.x, x.y, x.z, lbm::place_direction(p)}] = {k, links.q[g.begin + l], g.opposite + l};
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
    surfaces[k].motion = {{0.1 * double(surfaces[k].row), 0.2, -0.3},
                          {0.4, -0.5, 0.6 * double(surfaces[k].row)}};
  std::ranges::copy(lbm::components<lbm::D3Q19>.packed, block.slots.components);
  block.leave_to_device();
  block.begin_step(0, s.scene().flow->fields().domain(), {});
  const auto all = gap_links(surfaces);
  int between = 0, sides = 0, edges = 0, slipping = 0;
  for (const auto& [at, link] : all) {
    const auto other = all.find({at[0], at[1], at[2], lbm::opposite(at[3])});
    const auto& links = surfaces[link.surface].links;
    const Int3 c = lbm::D3Q19::c[at[3]];
    if (other == all.end()) {
      const Int3 behind{at[0] - c.x, at[1] - c.y, at[2] - c.z};
      EXPECT_FALSE(s.scene().flow->fields().domain().inside(behind)) << "a gap whose other wall is not known";
      const Side side = side_behind(behind, n, c);
      EXPECT_EQ(links.opposite_q[link.far], side.q);
      EXPECT_NEAR(links.opposite_u[link.far], side.u, 1e-15);
      ++(side.edge ? edges : side.q > 0 ? sides : slipping);
      continue;
    }
    between += other->second.surface != link.surface;
    const auto& [frame, motion] =
        std::tie(surfaces[other->second.surface].links.frame, surfaces[other->second.surface].motion);
    Vec3 arm, v(motion.v[0], motion.v[1], motion.v[2]), w(motion.omega[0], motion.omega[1], motion.omega[2]);
    for (int d = 0; d < 3; ++d) arm[d] = at[d] - frame.cell[d] + frame.offset[d];
    EXPECT_EQ(links.opposite_q[link.far], other->second.q);
    EXPECT_NEAR(links.opposite_u[link.far], Vec3(c.x, c.y, c.z).dot(v + w.cross(arm)), 1e-12);
  }
  EXPECT_GT(between, 0);
  EXPECT_GT(sides, 0);
  EXPECT_GT(edges, 0);
  EXPECT_GT(slipping, 0);
}

/// Returns how much velocities vary along a rod across a periodic domain, over the largest.
double variation_along(const std::string& rod, const std::string& device) {
  CaseText c;
  c.domain = domain_of({24, 8, 20}, "\"periodic\"");
  c.fluid = "[fluid]\nrelaxation_time = 0.7\nprecision = \"double\"\nbody_force = [1e-5, 0, 0]\n";
  c.shapes = rod;
  c.bodies = body_of("rod", 1, "position = [9.2, 4, 10.3]\norientation = [0, 1, 0]\nmotion = \"fixed\"");
  Simulation s = c.start(MPI_COMM_SELF, {"run.device=" + device});
  s.run(200);
  std::map<std::pair<int, int>, std::pair<Vec3, Vec3>> range;
  double largest = 0, variation = 0;
  const FluidFields& fields = s.scene().flow->fields();
  for_each_cell(fields, [&](int b, lbm::Int3 cell, lbm::Int3 at) {
    if (!fields.is_fluid(b, cell)) return;
    const Vec3 u = velocity(fields, b, cell);
    auto& [low, high] = range.try_emplace({at.x, at.z}, u, u).first->second;
    low = low.cwiseMin(u), high = high.cwiseMax(u);
    largest = std::max(largest, u.norm());
  });
  for (const auto& [column, of] : range) variation = std::max(variation, (of.second - of.first).norm());
  return variation / largest;
}

TEST(Links, OfRodsThatReachTheirOwnImageAreAlikeAllAlong) {
  for (const std::string device : {"cpu", "host"})
    EXPECT_LT(variation_along(shape_of("rod", "cylinder", "diameter = 8\nlength = 8"), device), 1e-12);
  EXPECT_GT(variation_along(shape_of("rod", "cylinder", "diameter = 8\nlength = 7.9"), "cpu"), 0.01);
}

}  // namespace
}  // namespace silt::coupler::testing

// Object mapping and cut links against an enumeration cell by cell, link by link.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "coupler/block_links.hpp"
#include "coupler/build_links.hpp"
#include "coupler/map_bodies.hpp"
#include "lbm/sweep.hpp"
#include "tests/coupler/coupled_scenes.hpp"

namespace silt::coupler {
namespace {

using lbm::Int3;
using rigid::Vec3;

/// What is where, asked of the shapes themselves; nothing of the map is used.
class Geometry {
 public:
  explicit Geometry(const Simulation& s)
      : world_(s.scene().world), bodies_(s.bodies()), domain_(s.scene().flow->domain()) {}

  /// A cell's centre from the nearest image of a body.
  Vec3 arm(std::size_t row, Int3 cell) const {
    Vec3 r = Vec3(cell.x + 0.5, cell.y + 0.5, cell.z + 0.5) - bodies_.mapping_pose[row].position;
    for (int d = 0; d < 3; ++d)
      if (domain_.periodic(d)) r[d] -= domain_.cells()[d] * std::round(r[d] / domain_.cells()[d]);
    return r;
  }
  /// The row of the body that has a cell: -1 none, -2 beyond a wall.
  int owner(Int3 cell) const {
    if (!domain_.inside(domain_.wrapped(cell))) return -2;
    int found = -1;
    for (std::size_t row = 0; row < bodies_.first_wall(); ++row) {
      const rigid::Quat& q = bodies_.mapping_pose[row].orientation;
      if (rigid::contains(world_.shapes[bodies_.shape[row]], q.conjugate() * arm(row, cell)) &&
          (found < 0 || bodies_.id[row] < bodies_.id[found]))
        found = int(row);
    }
    return found;
  }
  double distance(std::size_t row, Int3 cell, int i) const {
    const rigid::Quat& q = bodies_.mapping_pose[row].orientation;
    const Vec3 c(lbm::c[i].x, lbm::c[i].y, lbm::c[i].z);
    return rigid::ray_distance(world_.shapes[bodies_.shape[row]], q.conjugate() * arm(row, cell),
                               q.conjugate() * c, 1.0);
  }

 private:
  const rigid::World& world_;
  const rigid::BodySet& bodies_;
  const lbm::Domain& domain_;
};

struct Link {
  std::size_t row;
  bool narrow;
  double q;
  Vec3 arm;
};
using Links = std::map<std::tuple<int, int, int, int>, Link>;  // by cell of the block and direction

/// After a part of the dense pass, a cell and all around it have collided.
void expect_all_done(const lbm::Sweep& sweep, Int3 x, int part) {
  for (int z = x.z - 1; z <= x.z + 1; ++z)
    for (int y = x.y - 1; y <= x.y + 1; ++y) EXPECT_LE(sweep.part_of(y, z), part);
}

template <class T>
void add_links(const BlockMap& map, const BodyMask& mask, const lbm::CutLinks<T>& links, WallScheme scheme,
               Links& found) {
  const lbm::Sweep sweep(map.box.size, sizeof(T));
  for (const lbm::LinkGroup& g : links.groups) {
    const lbm::SurfaceFrame& frame = links.frame;
    EXPECT_EQ(g.begin % lbm::link_lanes, 0u);
    for (std::uint32_t l = g.begin; l < g.begin + g.count; ++l) {
      const std::uint32_t p = links.place[l];
      const Int3 x = g.corner + lbm::place_cell(p);
      bool rim = false;
      for (int d = 0; d < 3; ++d) rim |= x[d] == 0 || x[d] == map.box.size[d] - 1;
      EXPECT_EQ(rim, g.ready < 0);
      if (!rim) expect_all_done(sweep, x, g.ready);
      Vec3 arm;
      for (int d = 0; d < 3; ++d) arm[d] = x[d] - frame.cell[d] + frame.offset[d];
      EXPECT_LE(arm.norm(), frame.reach);
      const Link link{mask.row, g.scheme != scheme, double(links.q[l]), arm};
      EXPECT_TRUE(found.insert({{x.x, x.y, x.z, lbm::place_direction(p)}, link}).second)
          << "a link is listed twice";
    }
  }
}

/// Every link of a block, by its definition; adds the narrow ones. `surfaces`: of the mapping before, then of
/// this one.
template <class T>
void expect_all_links(const Simulation& s, const BlockMap& map, WallScheme scheme, double rounding,
                      std::vector<SurfaceLinks<T>>& surfaces, int& narrow_ones) {
  const Geometry geometry(s);
  CouplingSpec coupling;
  coupling.wall_scheme = scheme;
  build_links(map, s.scene().world, s.bodies(), coupling, {}, lbm::Sweep(map.box.size, sizeof(T)), surfaces);
  Links left;
  for (std::size_t k = 0; k < surfaces.size(); ++k)
    add_links(map, map.masks[k], surfaces[k].links, scheme, left);
  const Int3 n = map.box.size;
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x) {
        const Int3 cell = map.box.lower + Int3{x, y, z};
        if (geometry.owner(cell) != -1) continue;
        for (int i = 1; i < lbm::directions; ++i) {
          const int owner = geometry.owner(cell + lbm::c[i]);
          if (owner < 0) continue;
          const auto at = left.find({x, y, z, i});
          ASSERT_NE(at, left.end()) << "no link at " << x << " " << y << " " << z << " along " << i;
          const Link& link = at->second;
          EXPECT_EQ(int(link.row), owner);
          EXPECT_LT((link.arm - geometry.arm(owner, cell)).norm(), 1e-12);
          const bool blocked = geometry.owner(cell - lbm::c[i]) != -1;
          const double q = geometry.distance(owner, cell, i);
          if (scheme != WallScheme::bounce_back) {
            EXPECT_NEAR(link.q, q, rounding);
          }
          const bool reads = lbm::reads_behind(scheme, scheme == WallScheme::bouzidi ? q : 0);
          if (scheme != WallScheme::bouzidi || std::fabs(q - 0.5) > rounding) {
            EXPECT_EQ(link.narrow, blocked && reads);
          }
          narrow_ones += link.narrow;
          left.erase(at);
        }
      }
  EXPECT_TRUE(left.empty()) << left.size() << " links that are none";
}

/// The crowd after some steps, in blocks of several sizes, and then again with some of the bodies moved.
template <class T>
void check_crowd(const char* blocks, WallScheme scheme, double rounding) {
  Simulation s(crowd({blocks}), MPI_COMM_SELF);
  for (rigid::BodyId id = 1; id <= s.scene().body_count; ++id)
    s.set_velocity(id, 0.05 * Vec3(std::cos(1.7 * id), std::sin(1.7 * id), std::sin(3.4 * id)),
                   0.01 * Vec3(std::sin(1.7 * id), 0.3, -0.5));
  for (int t = 0; t < 80; ++t) s.step();
  const lbm::Domain& domain = s.scene().flow->domain();
  std::vector<lbm::CellBox> boxes;
  for (const auto& place : domain.blocks()) boxes.push_back(place.box);
  MapBodies map(domain, s.scene().world, boxes);
  std::vector<std::vector<SurfaceLinks<T>>> surfaces(boxes.size());
  int narrow = 0, kept = 0, spoilt = 0;  // spoilt: bodies at rest whose links others changed
  for (unsigned round = 0; round < 3; ++round) {
    map(s.bodies());
    for (std::size_t b = 0; b < boxes.size(); ++b)
      expect_all_links<T>(s, map.blocks()[b], scheme, rounding, surfaces[b], narrow);
    for (const BlockMap& block : map.blocks())
      for (const BodyMask& mask : block.masks)
        (mask.kept ? kept : spoilt) += block.changed && round > 0 && mask.id % 4 != round;
    for (std::size_t row = 0; row < s.bodies().first_wall(); ++row)
      if (s.bodies().id[row] % 4 == round + 1) s.bodies().mapping_pose[row].position += Vec3(0.3, -0.4, 0.2);
  }
  EXPECT_EQ(narrow > 0, scheme != WallScheme::bounce_back);
  EXPECT_GT(kept, 0);
  EXPECT_GT(spoilt, 0);
}

/// Where a link is, its surface, the places of its far wall (those that fill up its group too).
template <class T>
struct NarrowLink {
  std::size_t surface;
  T q;
  std::vector<std::uint32_t> far;
};

template <class T>
std::map<std::array<int, 4>, NarrowLink<T>> narrow_links(const std::vector<SurfaceLinks<T>>& surfaces) {
  std::map<std::array<int, 4>, NarrowLink<T>> found;
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    const auto& links = surfaces[k].links;
    for (const lbm::LinkGroup& g : links.groups)
      for (std::uint32_t l = 0; g.scheme == WallScheme::narrow && (l < g.count || l % lbm::link_lanes); ++l) {
        const std::uint32_t p = links.place[g.begin + l];
        const Int3 x = g.corner + lbm::place_cell(p);
        auto& link = found[{x.x, x.y, x.z, lbm::place_direction(p)}];
        link.surface = k, link.q = links.q[g.begin + l], link.far.push_back(g.far + l);
      }
  }
  return found;
}

/// The crowd between walls that move, flow in at y low and slip at z high.
Case crowd_between_sides() {
  return crowd({"domain.boundary.y=[{type='velocity-inlet',velocity=[0.01,0.02,-0.03]},'no-slip']",
                "domain.boundary.z=[{type='moving',velocity=[0.04,-0.05,0]},'free-slip']"});
}

/// Lets a box nearly fill an edge of the domain, another one lie just below the side that slips.
void put_boxes_at_sides(Simulation& s) {
  constexpr double gap = 0.8;  // the cells next to the side are fluid, those behind them solid
  const Vec3 places[] = {{12, gap + 3, gap + 2}, {5, 10, 28 - gap - 2}};
  for (std::size_t row = 0, found = 0; row < s.bodies().first_wall() && found < 2; ++row)
    if (std::holds_alternative<rigid::Box>(s.scene().world.shapes[s.bodies().shape[row]]))
      s.bodies().mapping_pose[row] = {places[found++], rigid::Quat::Identity()};
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

TEST(Links, NarrowOnesKnowTheWallOnTheOtherSide) {
  Simulation s(crowd_between_sides(), MPI_COMM_SELF);
  put_boxes_at_sides(s);
  const Int3 n = s.scene().flow->domain().cells();
  MapBodies map(s.scene().flow->domain(), s.scene().world, std::vector<lbm::CellBox>{{{}, n}});
  map(s.bodies());
  BlockLinks<double> block;
  auto& surfaces = block.surfaces;
  CouplingSpec coupling;
  coupling.wall_scheme = WallScheme::parabolic;
  build_links(map.blocks()[0], s.scene().world, s.bodies(), coupling, {},
              lbm::Sweep(map.blocks()[0].box.size, sizeof(double)), surfaces);
  for (std::size_t k = 0; k < surfaces.size(); ++k)
    surfaces[k].motion = {{0.1 * double(k), 0.2, -0.3}, {0.4, -0.5, 0.6 * double(k)}};
  block.gaps.pair(surfaces, s.scene().flow->domain(), {{}, n});
  block.gaps.set_velocities(surfaces);
  const auto all = narrow_links(surfaces);
  int between = 0, sides = 0, edges = 0, slipping = 0;
  for (const auto& [at, link] : all) {
    const auto other = all.find({at[0], at[1], at[2], lbm::opposite(at[3])});
    const auto& links = surfaces[link.surface].links;
    const Int3 c = lbm::c[at[3]];
    if (other == all.end()) {
      const Int3 behind{at[0] - c.x, at[1] - c.y, at[2] - c.z};
      EXPECT_FALSE(s.scene().flow->domain().inside(behind)) << "a gap whose other wall is not known";
      const Side side = side_behind(behind, n, c);
      for (const std::uint32_t far : link.far) {
        EXPECT_EQ(links.far_q[far], side.q);
        EXPECT_NEAR(links.far_u[far], side.u, 1e-15);
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
      EXPECT_EQ(links.far_q[far], other->second.q);
      EXPECT_NEAR(links.far_u[far], Vec3(c.x, c.y, c.z).dot(v + w.cross(arm)), 1e-12);
    }
  }
  EXPECT_GT(between, 0);
  EXPECT_GT(sides, 0);
  EXPECT_GT(edges, 0);
  EXPECT_GT(slipping, 0);
}

TEST(Links, AreThoseOfTheDefinition) {
  check_crowd<double>("domain.blocks=[24,20,28]", WallScheme::cli, 1e-9);
  check_crowd<double>("domain.blocks=[7,9,5]", WallScheme::bouzidi, 1e-9);
  check_crowd<float>("domain.blocks=[12,10,14]", WallScheme::cli, 2e-4);
  check_crowd<float>("domain.blocks=[12,5,28]", WallScheme::bounce_back, 0);
  check_crowd<double>("domain.blocks=[12,10,14]", WallScheme::parabolic, 1e-9);
}

/// A ball that comes to rest at mapping poses of our choice, and a smaller one of a lower id.
Case visited_ball() {
  return read_case_text(R"(
title = "visited"
[units]
system = "lattice"
[domain]
size = [18, 18, 18]
boundary = "periodic"
[fluid]
relaxation_time = 1.0
[[shapes]]
name = "visitor"
type = "sphere"
diameter = 3.3
[[shapes]]
name = "ball"
type = "sphere"
diameter = 5.4
[[bodies]]
shape = "visitor"
density = 1
position = [2.5, 2.5, 2.5]
[[bodies]]
shape = "ball"
density = 1
position = [9.0312, 8.9371, 9.0523]
[run]
steps = 1
)",
                        "visited");
}

// From within, where the visitor takes of the ball's cells without a change of what is solid, to where it is
// out of reach of its links.
TEST(Links, OfABodyAtRestFollowWhatVisitsItsCells) {
  Simulation s(visited_ball(), MPI_COMM_SELF);
  MapBodies map(s.scene().flow->domain(), s.scene().world, std::vector<lbm::CellBox>{{{}, {18, 18, 18}}});
  std::vector<SurfaceLinks<double>> surfaces;
  int narrow = 0, kept = 0, renewed = 0;
  const Vec3 centre = s.bodies().mapping_pose[1].position;
  for (int i = 1; i < lbm::directions; ++i)
    for (double distance = 1.05; distance < 9; distance += 0.55) {
      const Vec3 along = Vec3(lbm::c[i].x, lbm::c[i].y, lbm::c[i].z).normalized();
      s.bodies().mapping_pose[0].position = centre + distance * along;
      map(s.bodies());
      expect_all_links<double>(s, map.blocks()[0], WallScheme::cli, 1e-9, surfaces, narrow);
      ++(map.blocks()[0].masks.back().kept ? kept : renewed);
    }
  EXPECT_GT(kept, 10);
  EXPECT_GT(renewed, 10);
}

// Wider than a word, taller than a slab of planes.
Case large_bodies() {
  return read_case_text(R"(
title = "large"
[units]
system = "lattice"
[domain]
size = [96, 40, 44]
boundary = "periodic"
[fluid]
relaxation_time = 1.0
[[shapes]]
name = "egg"
type = "ellipsoid"
diameters = [74.6, 24.8, 34.4]
[[shapes]]
name = "ball"
type = "sphere"
diameter = 34.6
[[bodies]]
shape = "egg"
density = 1
position = [41.2173, 20.4291, 22.1357]
orientation = [0.98, 0.05, 0.1, 0.02]
[[bodies]]
shape = "ball"
density = 1
position = [90.1371, 3.2713, 1.3197]
[run]
steps = 1
)",
                        "large");
}

/// One body of every shape, oblique and in line with the axes, across the sides of the box.
Case one_of_each() {
  constexpr const char* pyramid =
      "vertices = [[4, 0, -2], [-1, 4.5, -2], [-4, -1, -2.5], [0, -4, -2], [0.5, 0.3, 5]]";
  std::string text = R"(
title = "one of each"
[units]
system = "lattice"
[domain]
size = [45, 30, 26]
boundary = "periodic"
[fluid]
relaxation_time = 1.0
[run]
steps = 1
)";
  const std::string shapes[][2] = {
      {"box", "edges = [8.3, 6.1, 4.7]"},
      {"capsule", "radius = 2.6\nlength = 5.3"},
      {"cylinder", "radius = 3.7\nlength = 6.2"},
      {"ellipsoid", "diameters = [9.1, 6.3, 4.9]"},
      {"polyhedron", pyramid},
      {"compound",
       "parts = [ { type = \"capsule\", radius = 1.6, length = 6, axis = [1, 0, 0] },\n"
       "{ type = \"capsule\", radius = 1.6, length = 6, axis = [0, 1, 0] },\n"
       "{ type = \"capsule\", radius = 1.6, length = 6, axis = [0, 0, 1] } ]"},
      {"compound",
       std::string("parts = [ { type = \"sphere\", radius = 2.2, position = [3, 1, 0] },\n"
                   "{ type = \"box\", edges = [4, 3, 2.5], position = [-2, 0, 1], axis = [1, 2, 3] },\n"
                   "{ type = \"cylinder\", radius = 1.1, length = 7, axis = [0, 1, 1] },\n"
                   "{ type = \"ellipsoid\", diameters = [3, 4, 5], position = [0, -2, -1] },\n"
                   "{ type = \"polyhedron\", position = [0, 1, 1], ") +
           pyramid + " } ]"}};
  std::string bodies;
  int n = 0;
  for (const auto& [type, sizes] : shapes) {
    const std::string name = type + std::to_string(n / 2);
    text += "[[shapes]]\nname = \"" + name + "\"\ntype = \"" + type + "\"\n" + sizes + "\n";
    for (const char* turn : {"[1, 0, 0, 0]", "[0.7, 0.3, -0.5, 0.2]"}) {
      const auto at = [](int slot, int slots, double size, double shift) {
        return std::to_string(std::fmod((slot + shift) * size / slots, size));
      };
      bodies += "[[bodies]]\nshape = \"" + name + "\"\ndensity = 1\norientation = " + turn +
                "\nposition = [" + at(n % 4, 4, 45, 0.93 + 0.0041 * n) + ", " +
                at(n / 4 % 2, 2, 30, 0.9173 + 0.0031 * n) + ", " + at(n / 8, 2, 26, 0.0341 + 0.0017 * n) +
                "]\n";
      ++n;
    }
  }
  return read_case_text(text + bodies, "one of each");
}

/// Every q of the domain, by global cell and direction.
using Distances = std::map<std::tuple<int, int, int, int>, double>;

template <class T>
Distances check_case(const Case& scene, Int3 block, double rounding) {
  Simulation s(scene, MPI_COMM_SELF);
  std::vector<lbm::CellBox> boxes;
  const Int3 n = s.scene().flow->domain().cells();
  for (int z = 0; z < n.z; z += block.z)
    for (int y = 0; y < n.y; y += block.y)
      for (int x = 0; x < n.x; x += block.x) boxes.push_back({{x, y, z}, block});
  MapBodies map(s.scene().flow->domain(), s.scene().world, boxes);
  map(s.bodies());
  Distances all;
  int narrow = 0;
  for (const BlockMap& b : map.blocks()) {
    std::vector<SurfaceLinks<T>> surfaces;
    expect_all_links<T>(s, b, WallScheme::cli, rounding, surfaces, narrow);
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

TEST(Links, OfEveryShape) {
  const Case scene = one_of_each();
  const Distances whole = check_case<double>(scene, {45, 30, 26}, 1e-9);
  EXPECT_EQ(whole, check_case<double>(scene, {15, 10, 13}, 1e-9));
  const Distances single = check_case<float>(scene, {15, 15, 13}, 3e-5);
  EXPECT_EQ(single, check_case<float>(scene, {9, 10, 26}, 3e-5));
  expect_close(single, whole, 1e-6);
}

TEST(Links, OfLargeBodies) {
  const Distances exact = check_case<double>(large_bodies(), {96, 40, 44}, 1e-9);
  expect_close(check_case<float>(large_bodies(), {96, 40, 44}, 5e-4), exact, 4e-6);
}

}  // namespace
}  // namespace silt::coupler

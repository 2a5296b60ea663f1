// Cells and wall distances of meshes, against what the mesh itself says of points and rays.
#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/mapping/build_links.hpp"
#include "coupler/mapping/map_bodies.hpp"
#include "lbm/blocks/pass_order.hpp"
#include "rigid/bodies/walls.hpp"
#include "rigid/shapes/shape.hpp"
#include "tests/rigid/shapes/meshes.hpp"

namespace silt::coupler::testing {
namespace {

using lbm::Int3;
using rigid::Mesh;
using rigid::Pose;
using rigid::Quat;
using rigid::Vec3;

constexpr int n = 32;

/// The links of a block by their cell in the domain and direction.
using Links = std::map<std::tuple<int, int, int, int>, double>;

struct Mapped {
  std::set<std::tuple<int, int, int>> solid;
  Links links;
};

std::array<lbm::SideCondition, 6> sides(lbm::SideKind kind) {
  std::array<lbm::SideCondition, 6> all;
  for (auto& side : all) side.kind = kind;
  return all;
}

/// A mesh in a domain of n^3 cells cut into blocks; of each block the cells inside and all links.
Mapped mapped(const Mesh& mesh, const Pose& pose, lbm::SideKind kind, Int3 blocks,
              WallScheme scheme = WallScheme::cli, Device device = Device::cpu) {
  const lbm::Domain domain({n, n, n}, sides(kind), blocks, 1);
  rigid::World world;
  rigid::BodySet bodies;
  rigid::add_wall(bodies, world, {mesh, pose, Vec3::UnitZ(), 0, {}});
  set_mapping_pose(bodies, bodies.first_wall(), bodies.pose(bodies.first_wall()));
  std::vector<lbm::CellBox> boxes;
  for (const auto& place : domain.blocks_of(0)) boxes.push_back(place.box);
  MapBodies map(domain, world, boxes, 1);
  map(bodies);
  Mapped found;
  CouplingSpec coupling;
  coupling.wall_scheme = scheme;
  for (const BlockMap& block : map.blocks()) {
    for_cells({}, block.box.size, [&](Int3 x) {
      const Int3 cell = block.box.lower + x;
      if (block.solid.test(x)) found.solid.insert({cell.x, cell.y, cell.z});
    });
    std::vector<SurfaceLinks<double>> surfaces;
    DeviceMapping<double> on_device(device);
    build_links<double>(block, world, bodies,
                        {coupling,
                         {},
                         lbm::PassOrder(block.box.size, sizeof(double)),
                         nullptr,
                         device == Device::cpu ? nullptr : &on_device},
                        surfaces);
    for (const auto& surface : surfaces)
      for (const lbm::LinkGroup& g : surface.links.groups)
        for (std::uint32_t l = 0; l < g.count; ++l) {
          const std::uint32_t p = surface.links.place[g.begin + l];
          const Int3 cell = block.box.lower + g.corner + lbm::place_cell(p);
          found.links[{cell.x, cell.y, cell.z, lbm::place_direction(p)}] = surface.links.q[g.begin + l];
        }
  }
  return found;
}

/// Reflects a link that leads from x beyond sides of the domain.
void reflect(Int3& x, Int3& along) {
  for (int d = 0; d < 3; ++d) {
    const int end = x[d] + along[d];
    if (end < 0 || end >= n) x[d] = (end < 0 ? 0 : 2 * n) - 1 - x[d], along[d] = -along[d];
  }
}

/// Every cell and link of it by the mesh's own answers; points nearer to the surface than rounding do not
/// count.
void expect_as_defined(const Mesh& mesh, const Pose& pose, lbm::SideKind kind = lbm::SideKind::bounce) {
  const Mapped found = mapped(mesh, pose, kind, {n, n, n});
  constexpr double rounding = 1e-6;
  const auto in_body = [&](Int3 x) { return pose.to_body(Vec3(x.x + 0.5, x.y + 0.5, x.z + 0.5)); };
  std::size_t links = 0;
  for_cells({}, {n, n, n}, [&](Int3 x) {
    const bool solid = found.solid.contains({x.x, x.y, x.z});
    if (mesh.surface->nearest(in_body(x), rounding).distance > rounding) {
      ASSERT_EQ(solid, mesh.contains(in_body(x))) << x.x << ' ' << x.y << ' ' << x.z;
    }
    if (solid) return;
    for (int i = 1; i < lbm::D3Q19::directions; ++i) {
      Int3 from = x, along = lbm::D3Q19::c[i];
      if (kind == lbm::SideKind::free_slip) reflect(from, along);
      const Int3 to = from + along;
      if (!found.solid.contains({to.x, to.y, to.z})) continue;
      ++links;
      const auto at = found.links.find({x.x, x.y, x.z, i});
      ASSERT_NE(at, found.links.end());
      const auto hit = mesh.surface->first_hit(in_body(from), in_body(to) - in_body(from), 1);
      if (hit) {
        EXPECT_NEAR(at->second, hit->t, rounding) << x.x << ' ' << x.y << ' ' << x.z << ' ' << i;
      }
    }
  });
  EXPECT_EQ(links, found.links.size());
  EXPECT_GT(links, 500u);
}

const Pose tilted{{15.3, 16.1, 16.7}, Quat(0.8, 0.3, -0.4, 0.2).normalized()};

TEST(MeshMapping, CellsAndLinksAreThoseOfTheSurface) {
  expect_as_defined(rigid::testing::solid_of(rigid::testing::torus_mesh(8, 3.3, 60, 30)), tilted);
  expect_as_defined(rigid::testing::solid_of(rigid::testing::cuboid_mesh({-9, -6, -4}, {8, 5, 7})), tilted);
  expect_as_defined(rigid::testing::vessel_of(rigid::testing::cuboid_mesh({-9, -6, -4}, {8, 5, 7})), tilted);
  expect_as_defined(rigid::testing::solid_of(rigid::testing::icosphere(10, 5)), tilted);
}

/// At three sides, and at the edges and the corner between them.
TEST(MeshMapping, AtFreeSlipSidesTheFluidSeesTheMirrorImage) {
  const rigid::TriangleMesh torus = rigid::testing::torus_mesh(8, 3.3, 60, 30);
  for (const Vec3& at : {Vec3(1.3, 31.1, 16.7), Vec3(15.3, 16.1, 30.3), Vec3(2.3, 28.4, 4.6)})
    expect_as_defined(rigid::testing::solid_of(torus), {at, tilted.orientation}, lbm::SideKind::free_slip);
}

/// A cube whose faces, edges and corners go through cell centres: each belongs to one side, and every link
/// has its distance.
TEST(MeshMapping, FacesThroughCellCentresAreDecided) {
  const Mesh mesh =
      rigid::testing::solid_of(rigid::testing::cuboid_mesh({8.5, 8.5, 8.5}, {20.5, 16.5, 24.5}));
  const Mapped found = mapped(mesh, {}, lbm::SideKind::bounce, {n, n, n});
  std::set<std::tuple<int, int, int>> solid;  // a centre on the surface is inside on its lower sides alone
  for_cells({8, 8, 8}, {20, 16, 24}, [&](Int3 x) { solid.insert({x.x, x.y, x.z}); });
  EXPECT_EQ(found.solid, solid);
  for (const auto& [key, q] : found.links) EXPECT_TRUE(q == 0 || q == 1) << q;
}

/// Edges and faces run through cell centres in every direction of the lattice.
TEST(MeshMapping, AnOctahedronWithItsCornersAtCellCentresIsDecided) {
  const std::vector<Vec3> corners = {{9, 0, 0}, {-9, 0, 0}, {0, 9, 0}, {0, -9, 0}, {0, 0, 9}, {0, 0, -9}};
  const std::vector<rigid::TriangleMesh::Triangle> faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                                            {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  const Mesh mesh = rigid::testing::solid_of({corners, faces});
  for (const Vec3& at : {Vec3(16.5, 16.5, 16.5), Vec3(16.5, 16.5, 16.0)})
    expect_as_defined(mesh, {at, Quat::Identity()});
}

TEST(MeshMapping, TheSameInAnyBlocks) {
  for (const lbm::SideKind kind :
       {lbm::SideKind::bounce, lbm::SideKind::periodic, lbm::SideKind::free_slip}) {
    const Mesh gear = rigid::testing::solid_of(rigid::testing::scaled(rigid::testing::gear_mesh(9, 3), 11));
    const bool inside = kind == lbm::SideKind::bounce;
    const Pose pose{inside ? tilted.position : Vec3(2.3, 30.1, 16.7), tilted.orientation};
    const Mapped whole = mapped(gear, pose, kind, {n, n, n});
    EXPECT_GT(whole.links.size(), 1000u);
    for (const Int3 blocks : {Int3{16, 16, 16}, Int3{8, 16, 32}, Int3{32, 8, 8}}) {
      const Mapped cut = mapped(gear, pose, kind, blocks);
      EXPECT_EQ(cut.solid, whole.solid);
      EXPECT_EQ(cut.links, whole.links);
    }
  }
}

/// Frees memory of a device that is not zero: what takes it next must not rely on what is there.
void spoil_memory(Device device) {
  std::vector<DeviceArray<std::uint64_t>> arrays;
  for (std::size_t words = 32; words <= 4096; words *= 2)
    for (int k = 0; k < 8; ++k) {
      arrays.emplace_back(memory_of(device)).resize(words);
      std::ranges::fill(arrays.back(), ~std::uint64_t{0});
    }
}

TEST(MeshMapping, ADeviceListsTheLinksThatAreCutHalfway) {
  for (const Device device : {Device::host, Device::gpu}) {
    if (!unusable(device).empty()) continue;
    spoil_memory(device);
    const Mesh mesh = rigid::testing::solid_of(rigid::testing::torus_mesh(8, 3.3, 60, 30));
    const auto links = [&](Device of) {
      return mapped(mesh, tilted, lbm::SideKind::bounce, {16, 16, 32}, WallScheme::bounce_back, of).links;
    };
    EXPECT_EQ(links(device), links(Device::cpu));
  }
}

/// Corners of a triangle 2^22 cells apart, between lattice points that look alike.
TEST(MeshMapping, AMeshMayBeMillionsOfCellsWide) {
  constexpr double wide = 1 << 22;
  const Mesh mesh = rigid::testing::solid_of(rigid::testing::cuboid_mesh(
      {10.3, 5.3 - wide / 2, 5.7 - wide / 2}, {10.3 + wide, 5.3 + wide / 2, 5.7 + wide / 2}));
  EXPECT_EQ(mapped(mesh, {}, lbm::SideKind::bounce, {n, n, n}).solid.size(), std::size_t(n - 10) * n * n);
}

/// In whole numbers a motion by whole cells changes nothing else.
TEST(MeshMapping, MovedByWholeCellsItIsMoved) {
  const Mesh mesh = rigid::testing::solid_of(rigid::testing::torus_mesh(6, 2.3, 40, 20));
  const Pose moved{tilted.position + Vec3(2, -3, 1), tilted.orientation};
  const Mapped a = mapped(mesh, tilted, lbm::SideKind::periodic, {n, n, n}),
               b = mapped(mesh, moved, lbm::SideKind::periodic, {n, n, n});
  ASSERT_EQ(a.solid.size(), b.solid.size());
  for (const auto& [x, y, z] : a.solid) EXPECT_TRUE(b.solid.contains({x + 2, y - 3, z + 1}));
  for (const auto& [key, q] : a.links) {
    const auto [x, y, z, i] = key;
    const auto at = b.links.find({(x + 2) % n, (y + n - 3) % n, (z + 1) % n, i});
    ASSERT_NE(at, b.links.end());
    EXPECT_NEAR(at->second, q, 1e-6);
  }
}

}  // namespace
}  // namespace silt::coupler::testing

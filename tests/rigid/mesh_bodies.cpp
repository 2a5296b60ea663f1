// Bodies that are meshes and bodies on walls of meshes, in motion: as the same shapes given otherwise, or by
// closed forms. g = 9.81.
#include <gtest/gtest.h>

#include "rigid/math/types.hpp"
#include "tests/rigid/scene.hpp"
#include "tests/rigid/shapes/meshes.hpp"

namespace silt::rigid {
namespace {

using testing::Scene;

using testing::g;

class MeshBodies : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override { testing::backend_name = GetParam(); }
  void TearDown() override { testing::backend_name = "analytic"; }
};
INSTANTIATE_TEST_SUITE_P(On, MeshBodies, ::testing::Values("auto", "analytic", "bullet", "fcl"),
                         [](const auto& name) { return std::string(name.param); });

void add_wall(Scene& s, const Mesh& mesh, const Vec3& x, const PrescribedMotion& motion = {}) {
  add_wall(s.bodies, s.world, {mesh, {x, Quat::Identity()}, Vec3::UnitZ(), 0, motion});
}

/// A ball that starts to slide and comes to roll; on a half-space, or on 10 000 random triangles.
Scene rolling(bool on_mesh, const Vec3& velocity) {
  Scene s(0, 0.3);
  s.world.gravity = {0, 0, -g};
  const double r = 0.37;
  s.add(s.shape(Sphere{r}), {20.1, 20.2, on_mesh ? 10 + r : r}, velocity);
  if (on_mesh)
    add_wall(s, testing::solid_of(testing::random_slab(70, 10, 50, 5)), {0, 0, 10});
  else
    s.floor();
  s.start();
  return s;
}

TEST_P(MeshBodies, BallOnRandomTrianglesRollsAsOnAPlane) {
  const Vec3 velocity(3, 1.7, 0);
  Scene on_mesh = rolling(true, velocity), on_plane = rolling(false, velocity);
  double off = 0;
  for (int i = 0; i < 5000; ++i) {
    on_mesh.run(1);
    on_plane.run(1);
    off = std::max(off, std::abs(on_mesh.x(0)[2] - 10.37));
    ASSERT_EQ(on_mesh.report.resolver.contacts, 1u) << i;
    ASSERT_LT((on_mesh.v(0) - on_plane.v(0)).norm(), 1e-6) << i;
    ASSERT_LT((on_mesh.w(0) - on_plane.w(0)).norm(), 1e-6) << i;
  }
  EXPECT_LT(off, 1e-9 * 0.37);
  EXPECT_GT((on_mesh.x(0) - Vec3(20.1, 20.2, 10.37)).norm(), 10);
}

/// Every solid slides over the seams and comes to rest where it does on a half-space.
TEST_P(MeshBodies, SlidingBodiesFeelNoSeams) {
  for (const ConvexShape& shape : std::initializer_list<ConvexShape>{
           Box{{0.5, 0.4, 0.2}}, Cylinder{0.5, 0.2}, Capsule{0.2, 0.5}, Ellipsoid{{0.5, 0.5, 0.2}}}) {
    const auto slide = [&](bool on_mesh) -> Vec3 {
      Scene s(0, 0.3);
      s.world.gravity = {0, 0, -g};
      const bool lies = std::holds_alternative<Capsule>(shape);
      const Quat q = rotation_between(Vec3::UnitZ(), lies ? Vec3::UnitY() : Vec3::UnitZ());
      s.append(0, s.shape(shape), {20, 20, (on_mesh ? 10 : 0) + 0.2}, q);
      s.bodies.reindex();
      s.bodies.set_velocity(0, {3, 0, 0}, Vec3::Zero());
      if (on_mesh)
        add_wall(s, testing::solid_of(testing::random_slab(70, 10, 50, 5)), {0, 0, 10});
      else
        s.floor();
      s.start();
      s.run(2000);
      return s.x(0) - (on_mesh ? 10 : 0) * Vec3::UnitZ();
    };
    EXPECT_LT((slide(true) - slide(false)).norm(), 1e-6) << shape_name(shape);
  }
}

TEST_P(MeshBodies, CubesStackAsBoxesDo) {
  const auto stack = [](const Shape& cube) {
    Scene s(0, 0.5);
    s.world.gravity = {0, 0, -g};
    const int shape = s.shape(cube);
    for (int i = 0; i < 6; ++i) s.add(shape, {10 + 0.02 * (i % 2), 10, 0.5 + i});
    s.floor();
    s.start();
    return s;
  };
  Scene s = stack(testing::solid_of(testing::cuboid_mesh(Vec3::Constant(-0.5), Vec3::Constant(0.5))));
  s.run(5000);
  for (BodyId i = 0; i < 6; ++i) {
    EXPECT_LT((s.x(i) - Vec3(10 + 0.02 * (i % 2), 10, 0.5 + i)).norm(), 1e-4) << i;
    EXPECT_LT(s.v(i).norm(), 1e-6) << i;
  }
}

/// One ring is held, the other hangs in it and swings.
TEST_P(MeshBodies, TwoRingsStayLinked) {
  Scene s(0.2, 0.3);
  s.world.gravity = {0, 0, -g};
  const int ring = s.shape(testing::solid_of(testing::torus_mesh(1, 0.2, 32, 16)));
  const Quat upright = rotation_between(Vec3::UnitZ(), Vec3::UnitX()),
             across = rotation_between(Vec3::UnitZ(), Vec3::UnitY());
  s.append(0, ring, {10, 10, 10}, upright);
  s.append(1, ring, {10, 10, 8.9}, across);
  s.bodies.motion[0] = Motion::fixed;
  s.bodies.reindex();
  s.bodies.set_velocity(1, {1, 0.5, 0}, {1, 2, 3});
  s.start();
  for (int i = 0; i < 4000; ++i) {
    s.run(1);
    ASSERT_LT((s.x(1) - s.x(0)).norm(), 1.65) << i;  // 2 (1 - 0.2) where they hang
  }
  EXPECT_LT(s.deepest, 0.02);
  EXPECT_NEAR(s.x(1)[2], 10 - 1.6, 0.1);
}

/// Balls poured into a funnel of triangles stay in it.
TEST_P(MeshBodies, FunnelKeepsItsBalls) {
  Scene s(0.3, 0.3);
  s.world.gravity = {0, 0, -g};
  const int ball = s.shape(Sphere{0.1});
  for (int i = 0; i < 200; ++i)
    s.add(ball, {9.4 + 0.24 * (i % 6) + 0.001 * (i % 7), 9.4 + 0.24 * (i / 6 % 6), 11 + 0.24 * (i / 36)});
  add_wall(s, testing::vessel_of(testing::lathe_mesh({{0, 0}, {0.15, 0}, {1, 1}, {1, 3}, {0, 3}}, 48)),
           {10, 10, 10});
  s.start();
  const Mesh vessel = std::get<Mesh>(s.world.shapes.back());
  s.run(4000);
  for (BodyId i = 0; i < 200; ++i)
    EXPECT_GT(vessel.signed_distance(s.x(i) - Vec3(10, 10, 10)), 0.1 - 5e-3) << i;
  s.deepest = 0;
  s.run(200);
  EXPECT_LT(s.deepest, 1e-3);
  EXPECT_LT(s.kinetic_energy() / 200, 1e-3);
}

/// A wall that turns carries what lies on it; one that comes along pushes.
TEST_P(MeshBodies, MovingWallsCarryAndPush) {
  Scene s(0, 0.5);
  const Mesh paddle = testing::solid_of(testing::cuboid_mesh({-4, -0.2, -0.5}, {4, 0.2, 0.5}));
  PrescribedMotion turns;
  turns.angular_velocity = {0, 0, 1};
  s.add(s.shape(Sphere{0.3}), {13, 10.7, 10});
  const MeshWallSpec wall{paddle, {{10, 10, 10}, Quat::Identity()}, Vec3::UnitZ(), 0, turns};
  add_wall(s.bodies, s.world, wall);
  s.start();
  const double dt = 1e-3;
  for (int i = 0; i < 600; ++i) {
    move_wall(s.bodies, s.bodies.first_wall(), wall, (i + 0.5) * dt);
    s.run(1, dt);
    const Pose pose = s.bodies.pose(s.bodies.first_wall());
    ASSERT_GT(pose.to_body(s.x(0))[1], 0.5 - 4e-3) << i;
  }
  EXPECT_GT(s.v(0).norm(), 2.5) << "3 where it was hit";
}

}  // namespace
}  // namespace silt::rigid

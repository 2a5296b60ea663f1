// Bodies and walls of triangles, and tubes: contacts, rolling and settling.
#include <gtest/gtest.h>

#include <cmath>

#include "rigid/collision/tube_contacts.hpp"
#include "rigid/math/types.hpp"
#include "tests/rigid/random.hpp"
#include "tests/rigid/shapes/meshes.hpp"
#include "tests/rigid/with_backend.hpp"
#include "tests/shape_rows.hpp"

namespace silt::rigid {
namespace {

using std::numbers::pi;
using testing::g;
using testing::random_turn;
using testing::Scene;
using testing::uniform;

class MeshBodies : public testing::WithBackend {};

void add_wall(Scene& s, const Mesh& mesh, const Vec3& x, const PrescribedMotion& motion = {}) {
  add_wall(s.bodies, s.world, {mesh, {x, Quat::Identity()}, Vec3::UnitZ(), 0, motion});
}

Shape any(const ConvexShape& shape) {
  return std::visit([](const auto& s) -> Shape { return s; }, shape);
}

/// A solid that slides on a half-space, or on 10 000 random triangles.
Scene sliding(bool on_mesh, const ConvexShape& shape, double height, const Vec3& velocity) {
  Scene s(0, 0.3);
  s.world.gravity = {0, 0, -g};
  const bool lies = std::holds_alternative<Capsule>(shape);
  const Quat q = rotation_between(Vec3::UnitZ(), lies ? Vec3::UnitY() : Vec3::UnitZ());
  s.add_with_id(0, s.shape(any(shape)), {{20.1, 20.2, (on_mesh ? 10 : 0) + height}, q}, velocity);
  if (on_mesh)
    add_wall(s, testing::solid_of(testing::random_slab(70, 10, 50, 5)), {0, 0, 10});
  else
    s.floor();
  s.start();
  return s;
}

TEST_F(MeshBodies, BallOnRandomTrianglesRollsAsOnAPlane) {
  const Vec3 velocity(3, 1.7, 0);
  Scene on_mesh = sliding(true, Sphere{0.37}, 0.37, velocity),
        on_plane = sliding(false, Sphere{0.37}, 0.37, velocity);
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
TEST_F(MeshBodies, SlidingBodiesFeelNoSeams) {
  for (const ConvexShape& shape : std::initializer_list<ConvexShape>{
           Box{{0.5, 0.4, 0.2}}, Cylinder{0.5, 0.2}, Capsule{0.2, 0.5}, Ellipsoid{{0.5, 0.5, 0.2}}}) {
    Scene on_mesh = sliding(true, shape, 0.2, {3, 0, 0}), on_plane = sliding(false, shape, 0.2, {3, 0, 0});
    on_mesh.run(2000), on_plane.run(2000);
    EXPECT_LT((on_mesh.x(0) - on_plane.x(0) - 10 * Vec3::UnitZ()).norm(), 1e-6) << shape_name(any(shape));
  }
}

TEST_F(MeshBodies, CubesStackAsBoxesDo) {
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
TEST_F(MeshBodies, TwoRingsStayLinked) {
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

/// A wall that turns carries what lies on it; one that comes along pushes.
TEST_F(MeshBodies, MovingWallsCarryAndPush) {
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

/// Returns how far a body reaches along the direction at an angle about the axis, from the axis.
double reach_along(const ConvexShape& shape, const Pose& pose, const Pose& tube, double angle) {
  const Vec3 n = tube.orientation * Vec3(std::cos(angle), std::sin(angle), 0);
  return n.dot(pose.to_world(support(shape, pose.orientation.conjugate() * n)) - tube.position);
}

/// The largest of those, by a fine search.
double furthest(const ConvexShape& shape, const Pose& pose, const Pose& tube) {
  constexpr int steps = 2000;
  double best = 0, at = 0, width = 2 * pi / steps;
  for (int k = 0; k < steps; ++k)
    if (const double r = reach_along(shape, pose, tube, k * width); r > best) best = r, at = k * width;
  for (int i = 0; i < 60; ++i, width *= 0.7)
    for (const double angle : {at - width, at + width})
      if (const double r = reach_along(shape, pose, tube, angle); r > best) best = r, at = angle;
  return best;
}

TEST(TubeContacts, GapIsThatOfASearchOverDirections) {
  for (const ConvexShape& shape : tests::all_solids())
    for (int i = 0; i < 20; ++i) {
      const Pose tube{{uniform(-2, 2), uniform(-2, 2), uniform(-2, 2)}, random_turn()};
      const double off = i < 5 ? 0.05 : 3;
      const Pose pose{tube.position + Vec3(uniform(-off, off), uniform(-off, off), uniform(-off, off)),
                      i % 5 == 0 ? tube.orientation : random_turn()};
      const double gap = gap_in_tube(any(shape), pose, Tube{3}, tube);
      EXPECT_NEAR(gap, 3 - furthest(shape, pose, tube), 1e-9) << shape_name(any(shape)) << ' ' << i;
    }
}

/// Points on both surfaces, normals from the axis outwards, features in order, the deepest among them.
TEST(TubeContacts, PointsLieOnBothSurfaces) {
  for (const ConvexShape& shape : tests::all_solids())
    for (int i = 0; i < 20; ++i) {
      const Pose tube{{1, 2, 3}, random_turn()},
          pose{tube.position + Vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)), random_turn()};
      std::vector<ContactPoint> points;
      append_tube_contacts(shape, pose, Tube{3}, tube, 10, points);
      ASSERT_FALSE(points.empty());
      double least = 10;
      for (std::size_t k = 0; k < points.size(); ++k) {
        const ContactPoint& p = points[k];
        const double inside = -signed_distance(any(shape), pose.to_body(p.on_a));
        EXPECT_GE(inside, -1e-12);
        if (!std::holds_alternative<Capsule>(
                shape)) {  // whose ball at one end may stand back behind its side
          EXPECT_LE(inside, 1e-12);
        }
        EXPECT_NEAR(signed_distance(Tube{3}, tube.to_body(p.on_b)), 0, 1e-12);
        EXPECT_NEAR((p.on_b - p.on_a - p.gap * p.normal).norm(), 0, 1e-12);
        const Vec3 n = tube.orientation.conjugate() * p.normal, x = tube.to_body(p.on_b);
        EXPECT_NEAR((n - Vec3(x[0], x[1], 0) / 3).norm(), 0, 1e-12);
        if (k > 0) {
          EXPECT_LT(points[k - 1].feature, p.feature);
        }
        least = std::min(least, p.gap);
      }
      EXPECT_NEAR(least, gap_in_tube(any(shape), pose, Tube{3}, tube), 1e-14);
    }
}

/// A disc on its flat side in a tube across its axis, and a long ellipsoid across it: two ends each.
TEST(TubeContacts, BodiesAcrossTheTubeTouchAtBothEnds) {
  const Quat upright = Quat::Identity(), along_x(Eigen::AngleAxisd(pi / 2, Vec3::UnitY()));
  const Pose tube{{0, 0, 2}, along_x};
  const auto touching = [&](const ConvexShape& shape, const Pose& pose) {
    std::vector<ContactPoint> points;
    append_tube_contacts(shape, pose, Tube{2}, tube, 1e-9, points);
    return points;
  };
  const double rim = 2 - std::sqrt(4 - 0.64);  // height of the tube 0.8 beside its lowest line
  auto points = touching(Cylinder{0.8, 0.1}, {{0, 0, rim + 0.1}, upright});
  ASSERT_EQ(points.size(), 2u);
  EXPECT_NEAR(std::abs(points[0].on_a[1]), 0.8, 1e-12);
  EXPECT_NEAR(points[0].on_a[1], -points[1].on_a[1], 1e-12);
  points = touching(Capsule{0.1, 0.8}, {{0, 0, 2}, Quat(Eigen::AngleAxisd(pi / 2, Vec3::UnitX()))});
  EXPECT_EQ(points.size(), 0u);
  EXPECT_EQ(touching(Ellipsoid{{0.1, 2, 0.1}}, {{0, 0, 2}, upright}).size(), 2u);
  EXPECT_EQ(touching(Cylinder{0.5, 1}, {{0, 0, 0.5}, along_x}).size(), 2u) << "along the tube: at both rims";
}

/// A tube along y with its lowest line at z = 0, and one body in it.
Scene in_tube(double radius, double friction, const Shape& shape, const Vec3& x, const Quat& q,
              double spin = 0) {
  Scene s(0, friction);
  s.world.gravity = {0, 0, -g};
  s.append(0, s.shape(shape), x, q);
  s.bodies.reindex();
  s.bodies.set_velocity(0, Vec3::Zero(), Vec3::Zero());
  add_wall(s.bodies, s.world, {Tube{radius}, {0, 0, radius}, Vec3::UnitY(), 0, spin});
  s.start();
  return s;
}

/// theta'' = -5 g / (7 (R - r)) sin theta: a ball that rolls.
TEST(Tube, BallRollsToAndFro) {
  const double R = 2, r = 0.25, swing = 0.02, period = 2 * pi / std::sqrt(5 * g / (7 * (R - r)));
  const Vec3 x(std::sin(swing) * (R - r), 3, R - std::cos(swing) * (R - r));
  Scene s = in_tube(R, 0.5, Sphere{r}, x, Quat::Identity());
  const int steps = 4000;
  s.run(steps, period / steps);
  EXPECT_NEAR(s.x(0)[0], x[0], 5e-3 * x[0]);
  EXPECT_NEAR(s.x(0)[1], 3, 1e-12);
  EXPECT_LT(s.deepest, 1e-4);
}

/// In a turning drum it stays at the lowest line and rolls on it.
TEST(Tube, BallSpinsOnATurningDrum) {
  const double R = 2, r = 0.25, omega = 1.5;
  Scene s = in_tube(R, 0.5, Sphere{r}, {0, 3, r}, Quat::Identity(), omega);
  s.bodies.set_velocity(0, Vec3::Zero(), {0, omega * R / r, 0});
  s.run(2000);
  EXPECT_NEAR(s.x(0)[0], 0, 1e-9);
  EXPECT_NEAR(s.w(0)[1] * r, omega * R, 1e-9);
}

/// Dropped at a slant, each stays in the tube and gains no energy; those that cannot roll come to rest.
TEST(Tube, EveryShapeSettles) {
  const double R = 4;
  for (const ConvexShape& shape : tests::all_solids()) {
    const Shape solid = recentred(any(shape), mass_properties(any(shape)).centre);
    const std::string name(shape_name(solid));
    const Quat q(Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized()));
    Scene s = in_tube(R, 0.8, solid, {0, 10, R}, q);
    const Pose tube = s.bodies.pose(s.bodies.first_wall());
    s.bodies.position[0][2] -= 0.9 * gap_in_tube(solid, s.bodies.pose(0), Tube{R}, tube);
    const auto energy = [&] { return s.kinetic_energy() + g * s.x(0)[2]; };
    const double start = energy();
    s.run(3000, 2e-3);
    EXPECT_LT(energy(), start) << name;
    EXPECT_GT(gap_in_tube(solid, s.bodies.pose(0), Tube{R}, tube), -2e-3) << name;
    if (std::holds_alternative<Box>(shape) || std::holds_alternative<Polyhedron>(shape)) {
      EXPECT_LT(s.kinetic_energy(), 1e-6) << name;
    }
  }
}

TEST(Walls, RowsOfTubes) {
  Scene s(0, 0);
  s.floor();
  add_wall(s.bodies, s.world, {Tube{3}, {1, 2, 3}, Vec3::UnitX(), 0, 0.5});
  add_wall(s.bodies, s.world, {Tube{4}, {1, 2, 3}, Vec3::UnitY(), 0, 0});
  EXPECT_EQ(s.bodies.walls, 3u);
  EXPECT_EQ(s.bodies.id, (std::vector<BodyId>{first_wall_id + 4, first_tube_id, first_tube_id + 1}));
  EXPECT_EQ(s.bodies.angular_velocity[1], Vec3(0.5, 0, 0));
  EXPECT_EQ(s.bodies.motion[1], Motion::prescribed);
  EXPECT_EQ(s.bodies.motion[2], Motion::fixed);
  EXPECT_LT((s.bodies.orientation[2] * Vec3::UnitZ() - Vec3::UnitY()).norm(), 1e-15);
}

}  // namespace
}  // namespace silt::rigid

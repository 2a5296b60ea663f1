// The fluid sees bodies and walls that move near where they are, and on the mean just there.
#include <gtest/gtest.h>

#include <cmath>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/mapping/mapping_poses.hpp"
#include "rigid/rigid_step.hpp"
#include "rigid/shapes/shape.hpp"
#include "tests/rigid/shapes/meshes.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Pose;
using rigid::Quat;
using rigid::Vec3;

constexpr double tolerance = 0.1;
constexpr double held = 0.15 * tolerance;  // where distances do not follow
const Vec3 half(3, 2, 1.5);                // of a box

/// Returns the largest distance between the places of a corner of the box in two poses.
double furthest(const Pose& a, const Pose& b) {
  double most = 0;
  for (int k = 0; k < 8; ++k) {
    const Vec3 corner(k & 1 ? half[0] : -half[0], k & 2 ? half[1] : -half[1], k & 4 ? half[2] : -half[2]);
    most = std::max(most, (a.to_world(corner) - b.to_world(corner)).norm());
  }
  return most;
}

CouplingSpec within(double cells, ForceForm force = ForceForm::galilean) {
  CouplingSpec coupling;
  coupling.remap_tolerance = cells, coupling.force = force;
  return coupling;
}

/// One body that goes on as it does, and what became of its mapping.
struct Passage {
  rigid::World world;
  rigid::BodySet bodies;
  rigid::Extent extent;
  int mappings = 0, steps = 0;
  double furthest_off = 0, furthest_from_foreseen = 0;
  Vec3 mean_off = Vec3::Zero();  // of its centre from where it is mapped

  Passage(const rigid::Shape& shape, const Vec3& velocity, const Vec3& spin) {
    world.shapes = {shape};
    world.bounding_radii = {rigid::bounding_radius(shape)};
    rigid::BodyRecord body;
    body.id = 1;
    body.motion = rigid::Motion::prescribed;
    bodies.add(body);
    bodies.reindex();
    bodies.set_velocity(0, velocity, spin);
    set_mapping_pose(bodies, 0, bodies.pose(0));
  }
  void run(int n, const CouplingSpec& coupling = within(tolerance)) {
    for (; steps < n; ++steps) {
      const Pose before = mapping_pose(bodies, 0);
      renew_mapping_poses(bodies, world, extent, coupling, steps);
      const MappedMotion& mapped = coupling_of(bodies, 0).mapped;
      const Pose now = bodies.pose(0);
      mappings += mapped.pose() != before;
      furthest_off = std::max(furthest_off, furthest(now, mapped.pose()));
      furthest_from_foreseen =
          std::max(furthest_from_foreseen, furthest(now, mapped.pose_after(steps - mapped.middle())));
      mean_off += (bodies.position[0] - mapped.position()) / n;
      rigid::drift(bodies, bodies.owned, 1);
      extent.wrap(bodies.position[0], bodies.image[0]);
    }
  }
};

TEST(MappingPoses, ABodyIsMappedAheadOnItsWay) {
  Passage p(rigid::Box{half}, {0.02, -0.01, 0.005}, {0.0015, 0.0025, -0.001});
  p.run(2000);
  EXPECT_LE(p.furthest_off, tolerance * (1 + 1e-6));
  EXPECT_GT(p.furthest_off, tolerance / 3);
  EXPECT_LT(p.furthest_from_foreseen, 1e-5);
  EXPECT_LT(p.mean_off.norm(), 0.02 * tolerance);
  const double speed = std::hypot(0.02, 0.01, 0.005) + half.norm() * std::hypot(0.0015, 0.0025, 0.001);
  const double within = 1 + std::floor(2 * tolerance / speed);  // steps
  EXPECT_NEAR(p.mappings, 2000 / std::pow(3, std::floor(std::log(within) / std::log(3))), 2);
}

TEST(MappingPoses, WhereDistancesDoNotFollow) {
  CouplingSpec bounce_back = within(tolerance);
  bounce_back.wall_scheme = WallScheme::bounce_back;
  const rigid::Mesh paddle = rigid::testing::solid_of(rigid::testing::cuboid_mesh(-half, half));
  const auto run = [&](const rigid::Shape& shape, const CouplingSpec& coupling) {
    Passage p(shape, {0.004, -0.002, 0.001}, {0.0003, 0.0005, -0.0002});
    p.run(2000, coupling);
    EXPECT_LT(p.mean_off.norm(), 0.02 * tolerance);
    EXPECT_LE(p.furthest_off, held * (1 + 1e-6));
    EXPECT_GT(p.furthest_off, held / 3);
    EXPECT_EQ(p.furthest_off, p.furthest_from_foreseen);
  };
  run(rigid::Box{half}, bounce_back);
  run(paddle, within(tolerance));
}

TEST(MappingPoses, BodiesAreMappedInCommonOddNumbersOfSteps) {
  Passage slow(rigid::Box{half}, {0.02, 0, 0}, {0, 0, 0}), fast(rigid::Sphere{3}, {0, 0.08, 0}, {0, 0, 0});
  slow.run(100), fast.run(100);
  int together = 0, mapped = 0;
  for (int step = 101; step < 1000; ++step) {
    const int slow_before = slow.mappings, fast_before = fast.mappings;
    slow.run(step), fast.run(step);
    mapped += slow.mappings - slow_before;
    together += slow.mappings > slow_before && fast.mappings > fast_before;
  }
  EXPECT_NEAR(mapped, 900 / 9, 2);  // fast: every third step
  EXPECT_EQ(together, mapped);
}

TEST(MappingPoses, ABodyThatIsNotWhereItWasForeseenIsMappedInBetween) {
  Passage p(rigid::Sphere{3}, {0.003, 0, 0}, {0, 0, 0});
  p.run(82);  // mapped in the last of them, for 27
  const int before = p.mappings;
  p.bodies.set_velocity(0, {0.005, 0, 0}, {0, 0, 0});
  p.run(82 + 8);  // 0.002 a step more than foreseen: 0.0165 in the ninth
  EXPECT_EQ(p.mappings, before);
  p.run(82 + 12);
  EXPECT_EQ(p.mappings, before + 1);
  EXPECT_LE(p.furthest_from_foreseen, 1.1 * held + 0.002);
}

TEST(MappingPoses, ABodyThatCrossesAPeriodicSideIsNotMappedForThat) {
  Passage straight(rigid::Box{half}, {0.003, 0, -0.001}, {0, 0, 0}), across = straight;
  across.extent = {{20, 20, 20}, {true, false, true}};
  straight.run(19000), across.run(19000);
  EXPECT_EQ(across.bodies.image[0][0], 2);
  EXPECT_EQ(across.bodies.image[0][2], -1);
  EXPECT_EQ(across.mappings, straight.mappings);
}

TEST(MappingPoses, ABodyThatStopsIsMappedWhereItRests) {
  Passage p(rigid::Box{half}, {0.02, 0, 0}, {0.001, 0, 0});
  p.run(40);
  p.bodies.set_velocity(0, {0, 0, 0}, {0, 0, 0});
  p.run(60);
  EXPECT_EQ(furthest(p.bodies.pose(0), mapping_pose(p.bodies, 0)), 0);
  EXPECT_TRUE(coupling_of(p.bodies, 0).mapped.is_at_rest());
  const int before = p.mappings;
  p.run(1000);
  EXPECT_EQ(p.mappings, before);
}

// A body that creeps is mapped where it is, not where it may be in a thousand steps.
TEST(MappingPoses, ABodyThatHardlyMovesStaysWhereItIsMapped) {
  Passage p(rigid::Box{half}, {1e-4, 0, 0}, {0, 0, 0});
  p.run(3000);
  EXPECT_LE(p.furthest_off, held * (1 + 1e-6));
  EXPECT_NEAR(p.mappings, 3000 / 243, 2);
}

TEST(MappingPoses, ABallIsNotMappedForTurning) {
  Passage p(rigid::Sphere{3}, {0, 0, 0}, {0.01, 0.02, 0});
  p.run(100);
  EXPECT_EQ(p.mappings, 0);
  Passage moving(rigid::Sphere{3}, {0.05, 0, 0}, {0.01, 0.02, 0});
  moving.run(1000);
  EXPECT_NEAR(moving.mappings, 1000 / 3, 2);
}

TEST(MappingPoses, WithoutATolerance) {
  Passage p(rigid::Box{half}, {0.004, 0, 0}, {0.0003, 0, 0});
  p.run(50, within(0));
  EXPECT_EQ(p.mappings, 49);
  EXPECT_EQ(p.furthest_off, 0);
}

TEST(MappingPoses, WallsAreMappedByTheStepAlone) {
  rigid::MeshWallSpec turns, swings, table;
  for (rigid::MeshWallSpec* wall : {&turns, &swings, &table}) {
    wall->mesh = rigid::testing::solid_of(rigid::testing::cuboid_mesh(-half, half));
    wall->start = {{10, 11, 12}, Quat(0.5, 0.1, -0.7, 0.3).normalized()};
  }
  turns.motion.angular_velocity = {0.0004, -0.0006, 0.0005}, turns.motion.velocity = {0.002, 0, 0};
  swings.motion.amplitude = {1, 0.5, 0}, swings.motion.frequency = 0.001;
  table.motion.table = {
      {0, {0, 0, 0}, {0, 0, 0}}, {300, {1, 0, 2}, {0.1, 0, 0}}, {800, {3, 0, 0}, {0.3, 0.1, 0}}};
  for (const rigid::MeshWallSpec* wall : {&turns, &swings, &table}) {
    const WallMapping mapping(*wall, tolerance);
    int mappings = 0;
    Vec3 mean_off = Vec3::Zero();
    for (int step = 0; step < 1000; ++step) {
      const Pose now = wall->motion.pose(wall->start, step), mapped = mapping.pose(step);
      EXPECT_LE(furthest(now, mapped), held * (1 + 1e-6)) << step;
      mappings += step == 0 || mapped != mapping.pose(step - 1);
      mean_off += (now.position - mapped.position) / 1000;
    }
    EXPECT_LT(mappings, 400);
    EXPECT_GT(mappings, 20);
    EXPECT_LT(mean_off.norm(), 0.05 * held);
    EXPECT_EQ(WallMapping(*wall, 0).pose(123), wall->motion.pose(wall->start, 123));
  }
}

}  // namespace
}  // namespace silt::coupler::testing

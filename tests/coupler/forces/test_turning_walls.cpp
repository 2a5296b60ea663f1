// The momentum that the cells of a turning wall take up and leave, counted cell by cell over a quarter turn.
#include <gtest/gtest.h>

#include <numbers>

#include "coupler/forces/turning_walls.hpp"
#include "rigid/bodies/walls.hpp"
#include "rigid/shapes/shape.hpp"
#include "tests/rigid/shapes/meshes.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Pose;
using rigid::Quat;
using rigid::Vec3;

const Vec3 half(20, 12, 8);  // of a block of stone

/// Momentum and angular momentum about the middle of the domain.
struct Turnover {
  Vec3 momentum = Vec3::Zero(), angular = Vec3::Zero();
  void add(const Vec3& p, const Vec3& at) { momentum += p, angular += at.cross(p); }
};

/// Calls visit(centre, is inside) for the cells of a cube about the middle of the domain.
template <class Visit>
void for_cells_about(const Pose& pose, Visit&& visit) {
  constexpr int reach = 40;
  for (int z = -reach; z < reach; ++z)
    for (int y = -reach; y < reach; ++y)
      for (int x = -reach; x < reach; ++x) {
        const Vec3 cell(x + 0.5, y + 0.5, z + 0.5);
        visit(cell, (pose.to_body(cell).cwiseAbs().array() < half.array()).all());
      }
}

/// A block, tilted, whose middle is at `arm` from the axis through the middle of the domain: what its cells
/// gain, counted, and what TurningWalls says, over a quarter turn.
struct QuarterTurn {
  Turnover counted, said;
  QuarterTurn(const Vec3& arm, bool hollow) {
    constexpr int steps = 150;
    const double turn = std::numbers::pi / 2 / steps;
    rigid::MeshWallSpec spec;
    spec.mesh = {std::make_shared<const rigid::TriangleMesh>(rigid::testing::cuboid_mesh(-half, half)),
                 hollow};
    spec.start.orientation = Quat(Eigen::AngleAxisd(0.5, Vec3::UnitY()));
    spec.start.position = Vec3(0.2, 0.3, 0.1);
    spec.arm = arm;
    spec.motion.angular_velocity = {0, 0, turn};
    rigid::World world;
    rigid::BodySet bodies;
    rigid::add_wall(bodies, world, spec);
    const std::size_t row = bodies.first_wall();
    TurningWalls walls(world);
    std::vector<bool> before;
    for (int step = 0; step <= steps; ++step) {
      rigid::move_wall(bodies, row, spec, step);
      const Pose pose = bodies.pose(row);
      std::vector<bool> now;
      for_cells_about(pose, [&](const Vec3& cell, bool inside) {
        const bool solid = inside != hollow, was = step > 0 ? before[now.size()] : solid;
        now.push_back(solid);
        if (solid == was) return;
        const Vec3 u = bodies.velocity_at(row, cell - pose.position);
        counted.add(solid ? u : Vec3(-u), cell);
      });
      before = now;
      if (step == 0) continue;
      for (const TurningWalls::Impulse& mean : walls.impulses(bodies))
        said.add(mean.momentum, pose.position + mean.arm);
    }
  }
};

void expect_near(const Turnover& found, const Turnover& wanted, double momentum, double angular) {
  EXPECT_LT((found.momentum - wanted.momentum).norm(), momentum) << found.momentum.transpose();
  EXPECT_LT((found.angular - wanted.angular).norm(), angular) << found.angular.transpose();
}

/// The bounds are a few parts in a hundred of what there is, for cells are not the block.
TEST(TurningWalls, CellsOfABlockBesideTheAxisGainWhatKeepsItsMiddleOnACircle) {
  for (const bool hollow : {false, true}) {
    const QuarterTurn beside({4, 3, 0}, hollow);
    EXPECT_GT(beside.counted.momentum.norm(), 800) << "the momentum that turns round";
    expect_near(beside.said, beside.counted, 0.03 * beside.counted.momentum.norm(),
                0.03 * beside.counted.angular.norm());
    const QuarterTurn about_itself({0, 0, 0}, hollow);
    EXPECT_GT(about_itself.counted.angular.norm(), 2000) << "the block is tilted against the axis";
    expect_near(about_itself.said, about_itself.counted, 40, 0.03 * about_itself.counted.angular.norm());
  }
}

/// A wall that moves without a turn needs none.
TEST(TurningWalls, NothingIsSaidOfAWallThatDoesNotTurn) {
  rigid::MeshWallSpec spec;
  spec.mesh = {std::make_shared<const rigid::TriangleMesh>(rigid::testing::cuboid_mesh(-half, half)), false};
  spec.motion.velocity = {0.1, 0, 0};
  rigid::World world;
  rigid::BodySet bodies;
  rigid::add_wall(bodies, world, spec);
  EXPECT_TRUE(TurningWalls(world).impulses(bodies).empty());
}

}  // namespace
}  // namespace silt::coupler::testing

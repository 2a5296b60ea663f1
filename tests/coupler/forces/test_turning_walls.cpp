// The momentum that the cells of a turning wall take up and leave, counted over a quarter turn.
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "coupler/forces/covered_momentum.hpp"
#include "rigid/bodies/walls.hpp"
#include "rigid/shapes/shape.hpp"
#include "tests/rigid/shapes/meshes.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Pose;
using rigid::Quat;
using rigid::Vec3;

const Vec3 half_block(20, 12, 8);  // of a block of stone

/// Momentum, and angular momentum about a point of the axis.
struct Turnover {
  Vec3 momentum = Vec3::Zero(), angular = Vec3::Zero();
  void add(const Vec3& p, const Vec3& at) { momentum += p, angular += at.cross(p); }
};

/// Adds `sign` times what the cells in the block have if they turn at a rate; a cell has a corner at
/// `corner`.
void add_cells(const Pose& pose, const Vec3& corner, const Vec3& rate, double sign, Turnover& to) {
  constexpr int reach = 32;  // no corner of the block is further from the axis
  for (int z = -reach; z < reach; ++z)
    for (int y = -reach; y < reach; ++y)
      for (int x = -reach; x < reach; ++x) {
        const Vec3 cell = corner + Vec3(x + 0.5, y + 0.5, z + 0.5);
        if ((pose.to_body(cell).cwiseAbs().array() < half_block.array()).all())
          to.add(sign * rate.cross(cell), cell);
      }
}

/// A block, tilted, whose middle is at `arm` from a point of the axis: what its cells gain in a quarter turn,
/// the mean over places in the grid, and what TurningWalls says. A hollow has the cells that the block has
/// not.
struct QuarterTurn {
  Turnover counted, said;
  QuarterTurn(const Vec3& arm, bool hollow) {
    constexpr int steps = 150, places = 16;
    rigid::MeshWallSpec spec;
    spec.mesh = {
        std::make_shared<const rigid::TriangleMesh>(rigid::testing::cuboid_mesh(-half_block, half_block)),
        hollow};
    spec.start.orientation = Quat(Eigen::AngleAxisd(0.5, Vec3::UnitY()));
    spec.arm = arm;
    const Vec3 rate(0, 0, std::numbers::pi / 2 / steps);
    spec.motion.angular_velocity = rate;
    rigid::World world;
    rigid::BodySet bodies;
    rigid::add_wall(bodies, world, spec);
    TurningWalls walls(world);
    for (int step = 0; step < steps; ++step) {
      rigid::move_wall(bodies, bodies.first_wall(), spec, step + 0.5);
      for (const TurningWalls::Impulse& mean : walls.impulses(bodies))
        said.add(mean.momentum, bodies.position[bodies.first_wall()] + mean.arm);
    }
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(0, 1);
    const double share = (hollow ? -1. : 1.) / places;
    for (int n = 0; n < places; ++n) {
      const Vec3 corner(place(random), place(random), place(random));
      add_cells(spec.pose(steps), corner, rate, share, counted);
      add_cells(spec.pose(0), corner, rate, -share, counted);
    }
  }
};

void expect_near(const Turnover& found, const Turnover& wanted, double momentum, double angular) {
  EXPECT_LT((found.momentum - wanted.momentum).norm(), momentum) << found.momentum.transpose();
  EXPECT_LT((found.angular - wanted.angular).norm(), angular) << found.angular.transpose();
}

/// The bounds are a few parts in a hundred of what there is, for cells are not the block.
TEST(TurningWalls, CellsOfABlockGainWhatKeepsItsMiddleOnACircle) {
  for (const bool hollow : {false, true}) {
    const QuarterTurn beside({4, 3, 0}, hollow), about_itself({0, 0, 0}, hollow);
    EXPECT_GT(beside.counted.momentum.norm(), 800) << "the momentum turns round";
    EXPECT_GT(about_itself.counted.angular.norm(), 2000) << "the block is tilted against the axis";
    const double one = 0.02 * beside.counted.momentum.norm(), two = 0.02 * beside.counted.angular.norm();
    expect_near(beside.said, beside.counted, one, two);
    expect_near(about_itself.said, about_itself.counted, one, two);
  }
}

/// A wall that moves without a turn needs none.
TEST(TurningWalls, NothingIsSaidOfAWallThatDoesNotTurn) {
  rigid::MeshWallSpec spec;
  spec.mesh = {
      std::make_shared<const rigid::TriangleMesh>(rigid::testing::cuboid_mesh(-half_block, half_block)),
      false};
  spec.motion.velocity = {0.1, 0, 0};
  rigid::World world;
  rigid::BodySet bodies;
  rigid::add_wall(bodies, world, spec);
  EXPECT_TRUE(TurningWalls(world).impulses(bodies).empty());
}

}  // namespace
}  // namespace silt::coupler::testing

// The coupling in time: the bound of its eigenvalues, and what bodies that rest or roll feel.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "coupler/forces/coupling_in_time.hpp"
#include "silt/simulation.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Mat3;
using rigid::Vec3;

/// A turn by up to an angle.
Eigen::Quaterniond random_turn(std::mt19937& random, double angle) {
  std::uniform_real_distribution<double> number(-1, 1);
  const Vec3 axis(number(random), number(random), number(random));
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle * number(random), axis.normalized()));
}

/// The resistance of links with random places and directions on a body, as in FluidForces: sum k J J^T.
Mat6 random_resistance(std::mt19937& random, const Vec3& reach) {
  std::uniform_real_distribution<double> number(-1, 1);
  const auto vec = [&] { return Vec3(number(random), number(random), number(random)); };
  Mat6 h = Mat6::Zero();
  for (int link = 0; link < 8; ++link) {
    const Vec3 c = vec(), arm = vec().cwiseProduct(reach);
    Eigen::Matrix<double, 6, 1> j;
    j << c, arm.cross(c);
    h += (1 + number(random)) * j * j.transpose();
  }
  return h;
}

Mat3 turned(const Vec3& moments, const Eigen::Quaterniond& q) {
  return q * moments.asDiagonal() * q.conjugate().toRotationMatrix();
}

double largest_eigenvalue(const Mat6& h, double mass, const Mat3& inertia_W) {
  Mat6 m = Mat6::Zero();
  m.topLeftCorner<3, 3>() = mass * Mat3::Identity();
  m.bottomRightCorner<3, 3>() = inertia_W;
  return Eigen::GeneralizedSelfAdjointEigenSolver<Mat6>(h, m).eigenvalues()[5];
}

TEST(EigenvalueBound, IsNeverClaimedAboveTheLimit) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(0, 1);
  int within = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vec3 reach(1 + 9 * number(random), 1 + 9 * number(random), 1 + 9 * number(random));
    const double mass = 10 + 100 * number(random);
    const Vec3 moments = mass / 5 * (Vec3::Constant(reach.squaredNorm()) - reach.cwiseAbs2());
    const Mat6 h = random_resistance(random, reach);
    const Mat3 inertia_B = turned(moments, random_turn(random, 0.3)),
               inertia_W = turned(moments, random_turn(random, M_PI));
    const double eigenvalue = largest_eigenvalue(h, mass, inertia_W);
    EXPECT_FALSE(largest_eigenvalue_is_within(0.999 * eigenvalue, h, mass, inertia_B));
    within += largest_eigenvalue_is_within(12 * eigenvalue, h, mass, inertia_B);
  }
  EXPECT_GT(within, 1000) << "a bound that is of no use";
}

// A sphere in line with the lattice: H is diagonal, and so the bound is the eigenvalue.
TEST(EigenvalueBound, OfASphereUpToTheLimit) {
  const double mass = 900, moment = 0.4 * mass * 36, limit = 0.16;
  for (int axis = 0; axis < 6; ++axis) {
    Mat6 h = Mat6::Identity();
    double& largest = h(axis, axis);
    largest = (1 - 1e-9) * limit * (axis < 3 ? mass : moment);
    EXPECT_TRUE(largest_eigenvalue_is_within(limit, h, mass, moment * Mat3::Identity())) << axis;
    largest = (1 + 1e-9) * limit * (axis < 3 ? mass : moment);
    EXPECT_FALSE(largest_eigenvalue_is_within(limit, h, mass, moment * Mat3::Identity())) << axis;
  }
}

TEST(EigenvalueBound, IsNotClaimedWhereThePrincipalMomentsAreUnknown) {
  Mat3 inertia = Mat3::Identity();
  inertia(0, 1) = inertia(1, 0) = inertia(1, 2) = inertia(2, 1) = 0.6;  // Gershgorin allows of -0.2
  EXPECT_FALSE(largest_eigenvalue_is_within(1, Mat6::Zero(), 1, inertia));
}

/// A box on the floor of a channel, not all symmetric to the stream.
CaseText box_in_a_stream(double density, const std::string& motion) {
  CaseText c;
  c.domain =
      domain_of({28, 20, 18}, "{ x = \"periodic\", y = \"periodic\", z = [\"no-slip\", \"no-slip\"] }");
  c.fluid = "[fluid]\nrelaxation_time = 0.65\nbody_force = [1e-5, 2e-6, 0]\n";
  c.rest = "[gravity]\nacceleration = [0, 0, -4e-3]\n[contacts]\nrestitution = 0\nfriction = 0.8\n";
  c.shapes = shape_of("box", "box", "edges = [7, 6, 8]");
  c.bodies = body_of("box", density, "position = [10, 10, 4]\nmotion = \"" + motion + "\"");
  return c;
}

BodyLoad load_after(const CaseText& c, int steps) {
  Simulation s = c.start(MPI_COMM_SELF);
  s.run(steps);
  return s.last_loads()[0];
}

TEST(BodiesThatRest, FeelWhatFixedOnesFeel) {
  constexpr int steps = 3000;
  for (const double density : {1.1, 3.0}) {
    const BodyLoad fixed = load_after(box_in_a_stream(density, "fixed"), steps),
                   held = load_after(box_in_a_stream(density, "free"), steps);
    EXPECT_GT(fixed.torque.norm(), fixed.force.norm());
    EXPECT_LT((held.force - fixed.force).norm(), 1e-4 * fixed.force.norm()) << density;
    EXPECT_LT((held.torque - fixed.torque).norm(), 1e-4 * fixed.torque.norm()) << density;
  }
}

/// The speed of a ball that rolls along the floor, or the ceiling if it floats, pressed on alike, once it is
/// steady: the mean over some ten cells, since a light one feels where it is in the lattice.
double rolling_speed(double density, bool lubrication) {
  CaseText c;
  c.domain =
      domain_of({24, 16, 16}, "{ x = \"periodic\", y = \"periodic\", z = [\"no-slip\", \"no-slip\"] }");
  c.fluid = "[fluid]\nrelaxation_time = 0.65\nbody_force = [1e-5, 0, 0]\n";
  if (!lubrication) c.fluid += "[coupling]\nlubrication = false\n";
  c.rest = "[gravity]\nacceleration = [0, 0, " + std::to_string(-1e-3 / (density - 1)) +
           "]\n[contacts]\nrestitution = 0\nfriction = 0.4\n";
  c.shapes = shape_of("ball", "sphere", "radius = 4");
  c.bodies = body_of("ball", density, density > 1 ? "position = [8, 8, 4]" : "position = [8, 8, 12]");
  Simulation s = c.start(MPI_COMM_SELF);
  s.run(4000);
  constexpr int steps = 8000;
  double speed = 0;
  for (int t = 0; t < steps; ++t) {
    s.step();
    speed += s.scene().bodies.velocity[0].x() / steps;
  }
  return speed;
}

TEST(BodiesThatRoll, AreAsFastWhateverTheirMass) {
  for (const bool lubrication : {true, false}) {
    const double heavy = rolling_speed(2.0, lubrication);
    EXPECT_GT(heavy, 1e-4);
    for (const double light : {0.05, 0.3})
      EXPECT_NEAR(rolling_speed(light, lubrication), heavy, 0.02 * heavy) << light << lubrication;
  }
}

}  // namespace
}  // namespace silt::coupler::testing

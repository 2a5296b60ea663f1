// The lubrication law: its resistances against the tabulated logarithms, its cut-offs and caps.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "coupler/forces/gap_cells.hpp"
#include "coupler/forces/lubrication.hpp"
#include "cpu/isa.hpp"
#include "tests/rigid/scene.hpp"

namespace silt::coupler::testing {
namespace {

using std::numbers::pi;
constexpr double mu = 0.1;
constexpr ResolvedFlow everywhere = {1.5, 0, 0, 0.5, 0.5};  // in the lattice
constexpr ResolvedFlows resolved = {everywhere, everywhere};

rigid::LubricatedGap spheres(double width, double a, double b) {
  rigid::Mat3 across = rigid::Mat3::Identity();
  across(2, 2) = 0;
  return {width, 0, across / a, across / b, rigid::Vec3::Zero(), rigid::Vec3::UnitZ()};
}
rigid::LubricatedGap wall(double width, double a) {
  return spheres(width, a, std::numeric_limits<double>::infinity());
}

TEST(Lubrication, NormalIsTheLeadingTermLessThatOfTheCutoff) {
  const Lubrication law(mu, resolved, 1e-9);
  const double a = 6, h = 0.1;
  EXPECT_NEAR(law(wall(h, a)).normal, 6 * pi * mu * a * a * (1 / h - everywhere.base), 1e-9);
  EXPECT_NEAR(law(spheres(h, a, a)).normal, 6 * pi * mu * a * a / 4 * (1 / h - everywhere.base), 1e-9);
  EXPECT_FALSE(law(wall(0.71, a)));
}

TEST(Lubrication, SlipAndRollingMakeGoldmansLogarithmsAtAWall) {
  // Goldman, Cox, Brenner, Chem. Eng. Sci. 22 (1967) 637: F = -(8/15) ln eps (6 pi mu a U), T = -(1/10) ln
  // eps (8 pi mu a^2 U) of translation; (2/15) (6 pi mu a^2 omega) and (2/5) (8 pi mu a^3 omega) of rotation
  const Lubrication law(mu, resolved, 1e-9);
  const double a = 6, log = std::log(0.5 / 0.01);
  const rigid::LubricationResistance f = law(wall(0.01, a));
  // slip U - a omega, rolling U + a omega
  EXPECT_NEAR(f.sliding + f.rolling, 8. / 15 * log * 6 * pi * mu * a, 1e-9);
  EXPECT_NEAR(a * (f.sliding - f.rolling), 0.1 * log * 8 * pi * mu * a * a, 1e-9);
  EXPECT_NEAR(a * (f.sliding - f.rolling), 2. / 15 * log * 6 * pi * mu * a * a, 1e-9);
  EXPECT_NEAR(a * a * (f.sliding + f.rolling), 2. / 5 * log * 8 * pi * mu * a * a * a, 1e-9);
}

TEST(Lubrication, SlipAndRollingMakeJeffreyAndOnishisLogarithmsOfUnequalSpheres) {
  // J. Fluid Mech. 139 (1984) 261: Y_A, Y_B, Y_C of sphere a, kappa = b/a
  const Lubrication law(mu, resolved, 1e-9);
  const double a = 4, log = std::log(0.5 / 0.01);
  for (const double kappa : {0.3, 1.0, 2.5}) {
    const double b = kappa * a, alpha = (a - b) / (a + b), k1 = 1 + kappa;
    const rigid::LubricationResistance f = law(spheres(0.01, a, b));
    EXPECT_NEAR(f.sliding + alpha * alpha * f.rolling,
                6 * pi * mu * a * 4 * kappa * (2 + kappa + 2 * kappa * kappa) / (15 * k1 * k1 * k1) * log,
                1e-9);
    EXPECT_NEAR(a * (f.sliding + alpha * f.rolling),
                8 * pi * mu * a * a * kappa * (4 + kappa) / (10 * k1 * k1) * log, 1e-9);
    EXPECT_NEAR(a * a * (f.sliding + f.rolling), 8 * pi * mu * a * a * a * 2 * kappa / (5 * k1) * log, 1e-9);
  }
}

TEST(Lubrication, AWayThroughTheGapIsTheMeanOverIt) {
  const Lubrication law(mu, resolved, 1e-3);
  rigid::LubricatedGap gap = wall(0.5, 6);
  gap.travel = -0.45;
  double sum = 0;
  constexpr int parts = 20000;
  for (int k = 0; k < parts; ++k) sum += law(wall(0.05 + 0.45 * (k + 0.5) / parts, 6)).normal;
  EXPECT_NEAR(law(gap).normal / (sum / parts), 1, 1e-6);
  rigid::LubricatedGap back = wall(0.05, 6);
  back.travel = 0.45;
  EXPECT_NEAR(law(back).normal / law(gap).normal, 1, 1e-12);
}

/// The sum over cells, tried one by one.
double counted(const rigid::LubricatedGap& gap, double radius) {
  double sum = 0;
  for (int x = -30; x < 30; ++x)
    for (int y = -30; y < 30; ++y)
      for (int z = -30; z < 30; ++z) {
        const rigid::Vec3 r = rigid::Vec3(x + 0.5, y + 0.5, z + 0.5) - gap.middle;
        const double below = gap.width / 2 + 0.5 * r.dot(gap.curvature_a * r);
        const double above = gap.width / 2 + 0.5 * r.dot(gap.curvature_b * r), s = r.dot(gap.normal);
        if (s > -below && s < above && below + above < 1) sum += (1 - below - above) * (1 - below - above);
      }
  return sum / (2 * pi * radius);
}

TEST(Lubrication, CountsTheCellsOfTheGap) {
  const rigid::Vec3 directions[] = {{0, 0, 1}, {-1, 0, 0}, {1, 2, -2}, {1, 1, 1}, {0.3, -0.9, 0.2}};
  for (const rigid::Vec3& d : directions)
    for (const double h : {0.05, 0.4, 0.9}) {
      const rigid::Vec3 n = d.normalized();
      const rigid::Mat3 across = rigid::Mat3::Identity() - n * n.transpose();
      for (const double b : {3.0, 1e9}) {
        const rigid::LubricatedGap gap{h, 0, across / 6, across / b, {0.3, -0.4, 0.15 + h}, n};
        EXPECT_NEAR(cells_in_gap(gap), counted(gap, 1 / (1 / 6. + 1 / b)), 1e-12)
            << d.transpose() << " " << h;
      }
    }
}

/// Principal curvatures p, q across n, turned about it.
rigid::Mat3 bent(const rigid::Vec3& n, double p, double q, double turn) {
  const rigid::Vec3 e = n.unitOrthogonal(), f = n.cross(e);
  const rigid::Vec3 t = std::cos(turn) * e + std::sin(turn) * f, u = n.cross(t);
  return p * t * t.transpose() + q * u * u.transpose();
}

TEST(Lubrication, CountsTheCellsBetweenSurfacesThatBendUnevenly) {
  std::mt19937 random(11);
  std::uniform_real_distribution<> one(-1, 1);
  for (int i = 0; i < 200; ++i) {
    const rigid::Vec3 n = rigid::Vec3(one(random), one(random), one(random)).normalized();
    const auto surface = [&] {
      return bent(n, 0.2 + 0.15 * one(random), 0.2 + 0.19 * one(random), 2 * one(random));
    };
    const rigid::LubricatedGap gap{
        0.4 + 0.6 * one(random), 0, surface(), surface(), {one(random), one(random), one(random)}, n};
    EXPECT_NEAR(cells_in_gap(gap), counted(gap, 1 / std::sqrt(gap.curvature_product())), 1e-12) << i;
  }
}

/// Instruction sets change no bit of a trajectory.
TEST(Lubrication, EveryBuildCountsTheSameBits) {
  const GapOnLattice gap{0.07,
                         {0.8, 0.48, -0.36},
                         {0.3, -0.7, 0.15},
                         {0.03, 0.07, 0.05, -0.02, 0.03, 0.01},
                         {0.06, 0.02, 0.04, 0.01, -0.02, 0.02},
                         -0.9,
                         5.5,
                         9.5,
                         3};
  const double sum = portable::sum_over_gap(gap);
  EXPECT_GT(sum, 1);
  if (chosen_isa() != Isa::portable) {
    EXPECT_EQ(avx2::sum_over_gap(gap), sum);
  }
  if (chosen_isa() == Isa::avx512) {
    EXPECT_EQ(avx512::sum_over_gap(gap), sum);
  }
}

TEST(Lubrication, ALayerOfCellsInTheGapIsResolvedBetterThanNone) {
  const Lubrication law(mu, {{0.8, 0.7, 2.4, 0.5, 0.5}, {}}, 1e-9);
  rigid::LubricatedGap gap = spheres(0.2, 6, 6);
  gap.middle = {0.5, 0.5, 0.5};
  const double on_cells = law(gap).normal;
  gap.middle[2] = 0;
  EXPECT_GT(law(gap).normal, 1.3 * on_cells);
}

/// A film takes from a velocity its resistance over the way, down as up: K ln(cutoff / least) in all.
TEST(Lubrication, WhatABounceLosesDependsNeitherOnTheStepNorOnThePlace) {
  const double radius = 5, least = 5e-3, start = 1, speed = 0.05;
  for (const auto& [stokes, restitution] : {std::pair(27.0, 0.97), {27.0, 0.6}, {152.0, 0.97}}) {
    const double film = std::log(1 / everywhere.base / least) / stokes;
    const double exact = restitution * (1 - film) - film;
    ASSERT_GT(exact, 0.1);
    for (const double dt : {1.0, 0.1})
      for (const double place : {0.0, 0.2, 0.4, 0.6, 0.8}) {
        rigid::testing::Scene s(restitution, 0);
        s.world.lubrication = std::make_shared<Lubrication>(mu, resolved, least);
        const double mass = stokes * 6 * pi * mu * radius * radius / speed;
        const rigid::BodyId ball =
            s.add(s.shape(rigid::Sphere{radius}), {50, 50, radius + start + place * speed * dt},
                  {0, 0, -speed}, {}, mass);
        s.floor();
        s.start();
        s.run(static_cast<int>(6 * start / (speed * exact * dt)), dt);
        EXPECT_GT(s.x(ball)[2], radius + start);
        EXPECT_NEAR(s.v(ball)[2] / speed, exact, dt == 1 ? 0.035 : 0.004) << stokes << " " << place;
      }
  }
}

TEST(Lubrication, IsCappedAtTheLeastGap) {
  const Lubrication law(mu, resolved, 1e-2);
  EXPECT_EQ(law(wall(1e-4, 6)).normal, law(wall(1e-2, 6)).normal);
  EXPECT_EQ(law(wall(-0.1, 6)).normal, law(wall(1e-2, 6)).normal);
  EXPECT_EQ(law(wall(-0.1, 6)).rolling, law(wall(1e-2, 6)).rolling);
}

}  // namespace
}  // namespace silt::coupler::testing

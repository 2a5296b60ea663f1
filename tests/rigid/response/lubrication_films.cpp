// Lubrication films between close surfaces: the rows of the resolver against closed forms, and what they may
// never do.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "rigid/bodies/walls.hpp"
#include "rigid/shapes/shape.hpp"
#include "tests/ray_distance.hpp"
#include "tests/rigid/scene.hpp"

namespace silt::rigid::testing {
namespace {

/// Resistances as given, the normal one over the gap.
class Honey final : public LubricationLaw {
 public:
  Honey(double reach, double normal, double sliding, double rolling)
      : reach_(reach), film_{normal, sliding, rolling} {}
  double reach() const override { return reach_; }
  LubricationResistance operator()(const LubricatedGap& gap) const override {
    return {film_.normal / std::max(gap.width, 1e-4), film_.sliding, film_.rolling};
  }

 private:
  double reach_;
  LubricationResistance film_;
};

Scene with_films(double reach, double normal, double sliding, double rolling, double friction = 0) {
  Scene s(0, friction);
  s.world.lubrication = std::make_shared<Honey>(reach, normal, sliding, rolling);
  s.settings.correction = 0;
  return s;
}

TEST(Films, ASpherePressedToAWallApproachesItExponentially) {
  Scene s = with_films(1, 50, 0, 0);
  s.world.gravity = {0, 0, -1};
  const double gap = 0.2, rate = 1.0 / 50;  // force over the resistance of unit gap
  const BodyId ball = s.add(s.shape(Sphere{1}), {50, 50, 1 + gap}, {0, 0, -gap * rate});
  s.floor();
  s.start();
  for (int k = 1; k <= 5; ++k) {
    s.run(2000, 5e-3);
    const double exact = gap * std::exp(-rate * 10 * k);
    EXPECT_NEAR((s.x(ball)[2] - 1) / exact, 1, 5e-3) << "time " << 10 * k;
  }
}

/// One step of a lubrication film's rows for spheres at rest but for one of them: (1 + dt M^-1 R) u = u_0,
/// the resistance R of slip s and rolling r as lubrication.hpp has them.
struct Planar {  // motion along x and about y, normal along z
  double v_a, w_a, v_b, w_b;
};
struct Ball {
  double radius, mass;
};
struct FilmRows {
  double gap, z_s, z_r;  // resistances times the step
};
Planar implicit_step(const Ball& sphere_a, const Ball& sphere_b, const FilmRows& film, const Planar& u) {
  const auto [a, mass_a] = sphere_a;
  const auto [b, mass_b] = sphere_b;
  const auto [gap, z_s, z_r] = film;
  const double reach_a = a + gap / 2, reach_b = b + gap / 2;
  const double alpha = (reach_a - reach_b) / (reach_a + reach_b);
  Eigen::Matrix<double, 2, 4> motion;   // omega x n = +x for omega along y, n along z
  motion << -1, -reach_a, 1, -reach_b,  // slip of b past a
      alpha, reach_a, -alpha, -reach_b;
  Eigen::Vector4d inverse_mass(1 / mass_a, 2.5 / (mass_a * a * a), 1 / mass_b, 2.5 / (mass_b * b * b));
  const Eigen::Matrix4d r = motion.transpose() * Eigen::Vector2d(z_s, z_r).asDiagonal() * motion;
  const Eigen::Matrix4d m = Eigen::Matrix4d::Identity() + inverse_mass.asDiagonal() * r;
  const Eigen::Vector4d after = m.inverse() * Eigen::Vector4d(u.v_a, u.w_a, u.v_b, u.w_b);
  return {after[0], after[1], after[2], after[3]};
}

TEST(Films, SlipAndRollingOfTwoSpheresAreTheImplicitSolution) {
  const double a = 1, b = 0.6, gap = 0.1, z_s = 3, z_r = 2, dt = 0.5;
  Scene s = with_films(1, 0, z_s, z_r);
  const BodyId first = s.add(s.shape(Sphere{a}), {50, 50, 50}, {1e-3, 0, 0}, {0, 2e-3, 0}, 1);
  const BodyId second =
      s.add(s.shape(Sphere{b}), {50, 50, 50 + a + b + gap}, {-5e-4, 0, 0}, {0, -4e-3, 0}, 0.3);
  s.start();
  const Planar exact = implicit_step({a, 1}, {b, 0.3}, {gap, dt * z_s, dt * z_r}, {1e-3, 2e-3, -5e-4, -4e-3});
  s.run(1, dt);
  EXPECT_NEAR(s.v(first)[0], exact.v_a, 1e-8);  // the normal has turned by 1e-4 in the half step
  EXPECT_NEAR(s.w(first)[1], exact.w_a, 1e-8);
  EXPECT_NEAR(s.v(second)[0], exact.v_b, 1e-8);
  EXPECT_NEAR(s.w(second)[1], exact.w_b, 1e-8);
  EXPECT_GT(std::abs(exact.v_a - 1e-3), 1e-4);
}

TEST(Films, SlipAndRollingAtAWallAreTheImplicitSolution) {
  const double a = 1, gap = 0.1, z_s = 3, z_r = 2, dt = 0.5;
  Scene s = with_films(1, 0, z_s, z_r);
  const BodyId ball = s.add(s.shape(Sphere{a}), {50, 50, a + gap}, {1e-3, 0, 0}, {0, 2e-3, 0});
  s.floor();
  s.start();
  s.run(1, dt);
  // a fixed sphere far larger than the ball, below it; the arm reaches the wall's point on the ball
  Eigen::Matrix2d motion;
  motion << 1, -a, 1, a;
  const Eigen::Matrix2d r = motion.transpose() * Eigen::Vector2d(dt * z_s, dt * z_r).asDiagonal() * motion;
  const Eigen::Matrix2d m = Eigen::Matrix2d::Identity() + Eigen::Vector2d(1, 2.5).asDiagonal() * r;
  const Eigen::Vector2d exact = m.inverse() * Eigen::Vector2d(1e-3, 2e-3);
  EXPECT_NEAR(s.v(ball)[0], exact[0], 1e-12);
  EXPECT_NEAR(s.w(ball)[1], exact[1], 1e-12);
}

/// Nothing resists a ball that turns with the drum as one body.
TEST(Films, ABallCarriedByATurningDrumFeelsNone) {
  const double radius = 8, gap = 0.1, spin = 1e-3, dt = 1e-2, middle = radius - 1 - gap;
  Scene s = with_films(1, 0, 300, 200);
  const BodyId ball = s.add(s.shape(Sphere{1}), {50 + middle, 50, 50}, {0, spin * middle, 0}, {0, 0, spin});
  add_wall(s.bodies, s.world, {Tube{radius}, {50, 50, 0}, Vec3::UnitZ(), 0, spin});
  s.start();
  s.run(5, dt);
  ASSERT_EQ(s.report.lubrication.with, 1u);
  EXPECT_NEAR(s.v(ball)[1] / (spin * middle), 1, 1e-3);
  EXPECT_NEAR(s.w(ball)[2] / spin, 1, 1e-3);
}

/// A ball that moves along the drum or on another way is slowed in the drum's frame as it is in one at rest.
TEST(Films, ADrumThatTurnsResistsInItsFrame) {
  const double radius = 8, gap = 0.1, dt = 1e-2, middle = radius - 1 - gap;
  const auto slowed = [&](double spin) {
    Scene s = with_films(1, 0, 3, 2);
    const BodyId ball = s.add(s.shape(Sphere{1}), {50 + middle, 50, 50}, {0, spin * middle + 1e-3, 2e-3},
                              {4e-3, -3e-3, spin + 2e-3});
    add_wall(s.bodies, s.world, {Tube{radius}, {50, 50, 0}, Vec3::UnitZ(), 0, spin});
    s.start();
    s.run(1, dt);
    return std::array<double, 4>{s.v(ball)[1] - spin * middle, s.v(ball)[2], s.w(ball)[1],
                                 s.w(ball)[2] - spin};
  };
  const auto still = slowed(0), turning = slowed(1e-2);
  EXPECT_LT(still[0], 0.99e-3);
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(turning[k], still[k], 1e-6) << k;
}

/// The wall gets the impulses that the ball remembers and the rest.
TEST(Films, AWallGetsWhatTheBallLoses) {
  for (const double fall : {0.0, -0.2, -12.0}) {
    Scene s = with_films(1, 0.3, 3, 2, 0.4);
    const BodyId ball = s.add(s.shape(Sphere{1}), {50, 50, 1.1}, {0.1, 0.02, fall}, {0.03, 0.2, 0.1});
    s.floor();
    s.start();
    s.run(1, 1e-6);  // in the first step of a run chains are solved once more, and what films did is not told
    const Vec3 p = s.momentum(), spin = s.w(ball);
    const double inertia = 0.4;
    s.run(1, 0.01);
    Vec3 impulse = Vec3::Zero(), moment = Vec3::Zero();
    const std::size_t row = s.bodies.row_of(ball);
    for (const StoredImpulse& stored : s.bodies.stored_impulses[row]) {
      impulse += stored.impulse;
      for (const Contact& c : s.step->contacts())
        if (c.feature == stored.feature) moment += c.r_a.cross(stored.impulse);
    }
    ASSERT_FALSE(s.step->other_impulses().empty());
    EXPECT_GT(s.step->other_impulses()[0].impulse.head<2>().norm(), 1e-4);
    for (const OtherImpulse& other : s.step->other_impulses()) {
      impulse += other.impulse;
      moment += s.step->contacts()[other.contact].r_a.cross(other.impulse) + other.moment;
    }
    EXPECT_LT((p - s.momentum() - impulse).norm(), 1e-14) << fall;
    EXPECT_LT((inertia * (spin - s.w(ball)) - moment).norm(), 1e-14) << fall;
  }
}

/// A cluster of balls of several sizes, one ellipsoid and one capsule, flying into each other.
Scene swarm(double friction, unsigned seed) {
  Scene s = with_films(0.5, 2, 1, 0.7, friction);
  std::mt19937 random(seed);
  std::normal_distribution<> normal;
  const auto vec = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  const int shapes[] = {s.shape(Sphere{0.5}), s.shape(Sphere{0.8}), s.shape(Ellipsoid{{0.9, 0.6, 0.5}}),
                        s.shape(Capsule{0.5, 0.5})};
  for (int k = 0; k < 27; ++k) {
    const Vec3 x(k % 3, k / 3 % 3, k / 9);
    s.add(shapes[k % 4], Vec3(50, 50, 50) + 2.05 * x, -0.3 * (x - Vec3(1, 1, 1)) + 0.1 * vec(), 0.3 * vec(),
          1 + k % 4);
  }
  s.start();
  return s;
}

TEST(Films, KeepMomentumAndOnlyTakeEnergy) {
  for (const double friction : {0.0, 0.4}) {
    Scene s = swarm(friction, 3);
    const Vec3 p = s.momentum(), l = s.angular_momentum();
    const double start = s.kinetic_energy();
    double energy = start;
    std::uint64_t films = 0;
    for (int i = 0; i < 400; ++i) {
      s.run(1, 1e-2);
      films += s.report.lubrication.with;
      EXPECT_LE(s.kinetic_energy(), energy * (1 + 1e-9)) << "step " << i;
      energy = s.kinetic_energy();
    }
    EXPECT_GT(films, 1000u);
    EXPECT_LT(energy, 0.5 * start);
    EXPECT_LT((s.momentum() - p).norm(), 1e-12);
    // positions move half a step between forces and their arms
    EXPECT_LT((s.angular_momentum() - l).norm(), 1e-3 * l.norm());
  }
}

TEST(Films, HoweverStiffTheyOnlyStop) {
  Scene s = with_films(1, 1e12, 1e12, 1e12);
  const BodyId ball = s.add(s.shape(Sphere{1}), {50, 50, 1.2}, {0.3, 0.1, -0.4}, {1, 2, 0}, 1e-3);
  s.floor();
  s.start();
  s.run(3, 0.1);
  EXPECT_LT(s.v(ball).norm(), 1e-9);
  EXPECT_LT(s.w(ball).head<2>().norm(), 1e-9);
}

TEST(Films, ABallBetweenManyNeighboursStopsWithThem) {
  Scene s = with_films(1, 40, 10, 5);  // a ring of heavy balls around a light one
  const int shape = s.shape(Sphere{1});
  const BodyId middle = s.add(shape, {50, 50, 50}, {0.2, 0.1, 0.05}, {0, 0, 0.3}, 1e-2);
  for (int k = 0; k < 6; ++k) {
    const double angle = k * std::acos(-1.0) / 3;
    s.add(shape, Vec3(50 + 2.1 * std::cos(angle), 50 + 2.1 * std::sin(angle), 50), Vec3::Zero(), Vec3::Zero(),
          100);
  }
  s.start();
  const Vec3 p = s.momentum();
  s.run(1, 0.1);
  EXPECT_LE(s.report.resolver.sweeps, 16);
  EXPECT_LT(s.v(middle).head<2>().norm(), 2e-3);
  EXPECT_LT((s.momentum() - p).norm(), 1e-13);
}

TEST(Films, TheContactStillStopsWhatAFilmLetsPass) {
  Scene s = with_films(0.5, 1e-3, 0, 0);
  const BodyId ball = s.add(s.shape(Sphere{1}), {50, 50, 1.5}, {0, 0, -1});
  s.floor();
  s.start();
  s.run(200, 1e-2);
  EXPECT_GE(s.x(ball)[2], 1 - 1e-9);
  EXPECT_NEAR(s.v(ball)[2], 0, 1e-6);
}

TEST(Films, NoneAtFlatFaces) {
  Scene s = with_films(0.5, 1, 1, 1);
  s.add(s.shape(Box{{1, 1, 1}}), {50, 50, 1.1}, {0, 0, -0.1});
  s.add(s.shape(Cylinder{1, 1}), {60, 50, 1.1}, {0, 0, -20});  // seen from afar, as it falls
  s.add(s.shape(Sphere{1}), {70, 50, 1.1});
  s.floor();
  s.start();
  s.run(1, 1e-2);
  EXPECT_EQ(s.report.lubrication.with, 1u);
  EXPECT_GE(s.report.lubrication.without, 4u);
}

TEST(Films, WithoutALawNothingIsSeenFromAfar) {
  Scene s(0, 0);
  s.add(s.shape(Sphere{1}), {50, 50, 1.1});
  s.floor();
  s.start();
  s.run(1, 1e-3);
  EXPECT_EQ(s.report.resolver.contacts, 0u);
  EXPECT_EQ(s.report.lubrication.with + s.report.lubrication.without, 0u);
}

/// The width between the surface and its tangent plane, by the distance along the normal.
double fall_of(const ConvexShape& shape, const Vec3& x, const Vec3& n, const Vec3& aside) {
  const double far = 1;
  const Shape any = std::visit([](const auto& s) -> Shape { return s; }, shape);
  return tests::ray_distance(any, x + far * n + aside, -n, 2 * far) - far;
}

TEST(Curvature, IsThatOfTheSurface) {
  // of an end of the cylinder and the box at a point inside the side
  const std::vector<std::tuple<ConvexShape, Vec3, std::optional<Vec3>>> cases = {
      {Sphere{2}, {1, 2, -0.5}, {}},
      {Ellipsoid{{3, 2, 1}}, {1, 2, 0.5}, {}},
      {Ellipsoid{{1, 1, 4}}, {0.3, -1, 2}, {}},
      {Capsule{1, 2}, {1, 1, 0}, {}},
      {Capsule{1, 2}, {1, 1, 2}, {}},
      {Cylinder{1, 2}, {1, 2, 0}, {}},
      {Cylinder{2, 2}, {0, 0, -1}, Vec3(0.3, 0.2, -2)},
      {Box{{1, 1, 2}}, {0, 1, 0}, Vec3(0.1, 1, 0.3)}};
  for (const auto& [shape, direction, at] : cases) {
    Vec3 x = at.value_or(support(shape, direction));
    if (!at && direction[2] == 0) x[2] = 0;  // of a straight side
    const Vec3 n = direction.normalized();
    const auto k = curvature(shape, x, n);
    ASSERT_TRUE(k);
    EXPECT_NEAR((*k * n).norm(), 0, 1e-12);
    for (int i = 0; i < 8; ++i) {
      const Vec3 t = n.cross(Vec3(std::cos(i), std::sin(i), 0.7 * i - 2)).normalized();
      const double step = 1e-3;
      EXPECT_NEAR(fall_of(shape, x, n, step * t), 0.5 * step * step * t.dot(*k * t), 2e-9) << i;
    }
  }
  EXPECT_FALSE(curvature(Box{{1, 1, 1}}, {1, 0, 1}, Vec3(1, 0, 1).normalized()));
  EXPECT_FALSE(curvature(Cylinder{1, 1}, {1, 0, 1}, Vec3(1, 0, 1).normalized()));
}

}  // namespace
}  // namespace silt::rigid::testing

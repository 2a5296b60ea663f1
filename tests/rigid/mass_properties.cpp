// Volume, centre, inertia; of compounds against exact unions.
#include <gtest/gtest.h>

#include <chrono>
#include <numbers>
#include <random>

#include "rigid/shape.hpp"

namespace silt::rigid {
namespace {

using std::numbers::pi;
constexpr double promised = 1e-4;

Quat z_to(const Vec3& axis) {
  return Quat::FromTwoVectors(Vec3::UnitZ(), axis);
}

TEST(MassProperties, ClosedForms) {
  const auto box = mass_properties(Box{{0.5, 1, 1.5}});
  EXPECT_DOUBLE_EQ(box.volume, 6);
  EXPECT_DOUBLE_EQ(box.inertia(0, 0), 6.0 / 12 * (4 + 9));
  const auto sphere = mass_properties(Sphere{2});
  EXPECT_DOUBLE_EQ(sphere.volume, 32 * pi / 3);
  EXPECT_DOUBLE_EQ(sphere.inertia(2, 2), 0.4 * sphere.volume * 4);
  // a capsule between a sphere and, by Monte Carlo, its own definition
  const Capsule c{0.6, 0.9};
  std::mt19937_64 g(1);
  std::uniform_real_distribution<> u(-1.5, 1.5);
  double volume = 0, along = 0, across = 0;
  const int n = 2000000;
  for (int i = 0; i < n; ++i) {
    const Vec3 x(0.4 * u(g), 0.4 * u(g), u(g));
    if (!contains(c, x)) continue;
    volume += 1, along += x[0] * x[0] + x[1] * x[1], across += x[1] * x[1] + x[2] * x[2];
  }
  const double cell = 1.2 * 1.2 * 3 / n;
  const auto p = mass_properties(c);
  EXPECT_NEAR(volume * cell / p.volume, 1, 3e-3);
  EXPECT_NEAR(along * cell / p.inertia(2, 2), 1, 3e-3);
  EXPECT_NEAR(across * cell / p.inertia(0, 0), 1, 3e-3);
}

TEST(MassProperties, ApartPartsAddUpExactly) {
  const auto p = mass_properties(
      Compound{{{Sphere{1}, {{-2, 0, 0}, Quat::Identity()}}, {Sphere{1}, {{2, 0, 0}, Quat::Identity()}}}});
  const double v = 4 * pi / 3;
  EXPECT_NEAR(p.volume, 2 * v, 1e-14);
  EXPECT_NEAR(p.inertia(0, 0), 2 * 0.4 * v, 1e-13);
  EXPECT_NEAR(p.inertia(1, 1), 2 * v * (0.4 + 4), 1e-12);
  EXPECT_EQ(p.centre, Vec3::Zero());
}

TEST(MassProperties, TwoSpheresAndTheirLens) {
  const double r = 1.0;
  for (double d : {0.3, 1.0, 1.7}) {
    const auto p = mass_properties(Compound{
        {{Sphere{r}, {{0, 0, -d / 2}, Quat::Identity()}}, {Sphere{r}, {{0, 0, d / 2}, Quat::Identity()}}}});
    const double lens = pi * (4 * r + d) * (2 * r - d) * (2 * r - d) / 12;
    EXPECT_NEAR(p.volume / (8 * pi / 3 - lens) - 1, 0, promised / 5) << d;
    // about the axis: each half is a sphere cut at z = 0: integral of pi/2 rho^4 dz
    double axial = 0;
    const int n = 200000;
    const double h = (r + d / 2) / n;
    for (int i = 0; i < n; ++i) {
      const double z = (i + 0.5) * h, rho2 = r * r - (z - d / 2) * (z - d / 2);
      axial += pi / 2 * rho2 * rho2 * h;
    }
    EXPECT_NEAR(p.inertia(2, 2) / (2 * axial) - 1, 0, promised / 5) << d;
    EXPECT_EQ(p.centre, Vec3::Zero());
  }
}

TEST(MassProperties, CrossedBoxes) {
  const double l = 2, w = 0.35;  // half edges of three bars crossed at the centre
  const Compound star{{{Box{{l, w, w}}, {}}, {Box{{w, l, w}}, {}}, {Box{{w, w, l}}, {}}}};
  const auto p = mass_properties(star);
  const double bar = 8 * l * w * w, cube = 8 * w * w * w;
  EXPECT_NEAR(p.volume / (3 * bar - 2 * cube) - 1, 0, promised / 5);
  const double inertia = bar / 3 * (2 * w * w) + 2 * bar / 3 * (l * l + w * w) - 2 * cube / 3 * (2 * w * w);
  for (int d = 0; d < 3; ++d) EXPECT_NEAR(p.inertia(d, d) / inertia - 1, 0, promised / 5);
  EXPECT_EQ(p.inertia(0, 0), p.inertia(1, 1)) << "a symmetric star needs no gyroscopic term";
  EXPECT_EQ(p.inertia(0, 1), 0);
}

TEST(MassProperties, BoxesFaceToFaceAndNested) {
  // half of the second lies in the first: a bar of length 3
  const auto p =
      mass_properties(Compound{{{Box{{1, 1, 1}}, {}}, {Box{{1, 1, 1}}, {{1, 0, 0}, Quat::Identity()}}}});
  EXPECT_NEAR(p.volume / 12 - 1, 0, promised);
  EXPECT_NEAR(p.centre[0], 0.5, promised);
  EXPECT_NEAR(p.inertia(0, 0) / (12.0 / 12 * 8) - 1, 0, promised);
  EXPECT_NEAR(p.inertia(1, 1) / (12.0 / 12 * (9 + 4)) - 1, 0, promised);
  const auto nested =
      mass_properties(Compound{{{Sphere{1}, {}}, {Sphere{0.4}, {{0.2, 0, 0}, Quat::Identity()}}}});
  EXPECT_NEAR(nested.volume / (4 * pi / 3) - 1, 0, promised / 5);
}

TEST(MassProperties, StarOfCapsulesTurnsWithItsAxes) {
  const auto star = [](const Quat& turn) {
    Compound c;
    for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
      c.parts.push_back({Capsule{0.3, 1.1}, {Vec3::Zero(), turn * z_to(axis)}});
    return c;
  };
  const auto before = std::chrono::steady_clock::now();
  const auto p = mass_properties(star(Quat::Identity()));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
  const auto q = mass_properties(star(Quat(0.3, 0.5, -0.2, 0.7).normalized()));
  EXPECT_NEAR(p.volume / q.volume - 1, 0, promised / 5);
  EXPECT_NEAR(p.inertia.trace() / q.inertia.trace() - 1, 0, promised / 5);
  EXPECT_LT(seconds, 2.0);  // generous: the machine may be shared
  // three crossed cylinders of radius r have in common with each other Steinmetz' solids (16/3 r^3, 8 (2 -
  // sqrt 2) r^3)
  const double r = 0.3, one = mass_properties(Capsule{0.3, 1.1}).volume;
  const double exact = 3 * one - 3 * 16.0 / 3 * r * r * r + 8 * (2 - std::sqrt(2.0)) * r * r * r;
  EXPECT_NEAR(p.volume / exact - 1, 0, promised / 5);
  RecordProperty("milliseconds", static_cast<int>(1000 * seconds));
}

}  // namespace
}  // namespace silt::rigid

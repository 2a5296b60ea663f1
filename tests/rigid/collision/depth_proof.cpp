// What proves a depth of overlap the least, against many directions that might be less deep.
#include <gtest/gtest.h>

#include <random>

#include "rigid/collision/deepest_direction.hpp"
#include "tests/shape_rows.hpp"

namespace silt::rigid {
namespace {

ConvexShape sharp_shape(std::mt19937_64& random) {
  const tests::Sizes size(random);
  Vec3 s = size.three();
  if (random() % 3 == 0) s[random() % 2] *= 0.05;  // thin, or flat
  switch (random() % 4) {
    case 0:
      return Box{0.5 * s};
    case 1:
      return Cylinder{0.5 * s.x(), 0.5 * s.y()};
    case 2:
      return Cone{0.5 * s.x(), s.y()};
    default:
      return tests::random_polyhedron(size);
  }
}

Quat turned_anyhow(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
}

/// Where the cores meet along unit n.
CommonPoint point_met(const ConvexCore& a, const ConvexCore& b, const Peak& peak) {
  const double slack = 1e-10 * length_scale(a, b);
  ContactOutline of_a, of_b;
  a.touching_outline(peak.normal, slack, of_a);
  b.touching_outline(-peak.normal, slack, of_b);
  return common_point(of_a, of_b, peak.normal, peak.core_gap, 10 * slack);
}

/// Of directions all over, and of peaks near some of them.
double highest_anywhere(const ConvexCore& a, const ConvexCore& b, std::mt19937_64& random) {
  double best = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < 300; ++k) best = std::max(best, core_separation(a, b, tests::random_direction(random)));
  for (int k = 0; k < 30; ++k)
    best = std::max(best, climb(a, b, tests::random_direction(random), 0.3).core_gap);
  return best;
}

/// Depths from 1e-6 of the size on, each a local peak, the highest or not.
TEST(DepthProof, IsTrueOfNoDepthThatIsNotTheLeast) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> unit(0, 1);
  int proven = 0, not_least = 0;
  for (int pair = 0; pair < 4000; ++pair) {
    const ConvexShape shape_a = sharp_shape(random), shape_b = sharp_shape(random);
    const Quat turn_a = turned_anyhow(random), turn_b = turned_anyhow(random);
    const ConvexCore a = convex_core(shape_a, {Vec3::Zero(), turn_a});
    const auto b_at = [&](const Vec3& x) { return convex_core(shape_b, {x, turn_b}); };
    const Vec3 apart = 80 * tests::random_direction(random);
    const Peak nearest = climb(a, b_at(apart), apart.normalized(), 0.6);
    const double depth = std::pow(10, -6 * unit(random)) * length_scale(a, b_at(Vec3::Zero()));
    const ConvexCore b = b_at(apart - (nearest.core_gap + depth) * nearest.normal);
    const double scale = length_scale(a, b);
    for (int start = 0; start < 3; ++start) {
      const Peak peak = climb(a, b, start ? tests::random_direction(random) : nearest.normal, 0.6);
      if (peak.core_gap >= 0) continue;
      const CommonPoint where = point_met(a, b, peak);
      if (where.miss > 1e-12 * scale) continue;
      const bool proof = is_least_depth(a, b, peak.normal, -peak.core_gap, where);
      const double highest = highest_anywhere(a, b, random);
      proven += proof;
      not_least += highest > peak.core_gap + 1e-9 * scale;
      if (proof) {
        EXPECT_LE(highest, peak.core_gap + 1e-11 * scale) << pair;
      }
    }
  }
  EXPECT_GT(not_least, 1000);  // of which a wrong proof would be true
  EXPECT_GT(proven, 1000);
}

/// Else every such contact would be a search.
TEST(DepthProof, KnowsRimsThatCross) {
  std::mt19937_64 random(12);
  int crossing = 0;
  while (crossing < 300) {
    const tests::Sizes size(random);
    const ConvexShape shape_a = Cylinder{size(), size()}, shape_b = Cylinder{size(), size()};
    const Quat turn_a = turned_anyhow(random), turn_b = turned_anyhow(random);
    const Vec3 n = tests::random_direction(random);
    const Vec3 axis_a = turn_a * Vec3::UnitZ(), axis_b = turn_b * Vec3::UnitZ();
    const Vec3 rim_a = axis_a.cross(n), rim_b = axis_b.cross(n);
    if (rim_a.norm() < 0.3 || rim_b.norm() < 0.3 || axis_a.dot(n) < 0.3 || axis_b.dot(n) > -0.3) continue;
    if (rim_a.normalized().cross(rim_b.normalized()).norm() < 0.5) continue;
    ++crossing;
    const ConvexCore a = convex_core(shape_a, {Vec3::Zero(), turn_a});
    const ConvexCore there = convex_core(shape_b, {Vec3::Zero(), turn_b});
    const double depth = 1e-3 * length_scale(a, there);
    const Vec3 x = a.support(n);
    const ConvexCore b = convex_core(shape_b, {x - depth * n - there.support(-n), turn_b});
    EXPECT_TRUE(is_least_depth(a, b, n, depth, {x, x - depth * n, 0, 0, 0}));
  }
}

}  // namespace
}  // namespace silt::rigid

// Proofs of the least depth of overlap, of polytopes and of round shapes.
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
    case 2:
      return Cylinder{0.5 * s.x(), 0.5 * s.y()};
    default:
      return tests::random_polyhedron(size);
  }
}

Quat turned_anyhow(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
}

/// Returns a point in which the outlines of the cores meet along the normal of a peak.
CommonPoint point_met(const ConvexCore& a, const ConvexCore& b, const Peak& peak) {
  const double slack = 1e-10 * length_scale(a, b);
  ContactOutline of_a, of_b;
  a.touching_outline(peak.normal, slack, of_a);
  b.touching_outline(-peak.normal, slack, of_b);
  return common_point(of_a, of_b, peak.normal, peak.core_gap, 10 * slack);
}

/// Tries directions all over, and peaks near some of them.
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
  int crossing = 0, known = 0;
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
    known += is_least_depth(a, b, n, depth, {x, x - depth * n, 0, 0, 0});
  }
  EXPECT_EQ(known, crossing);
}

Pose random_pose(std::mt19937_64& random, double reach) {
  std::normal_distribution<double> normal;
  return {reach * tests::random_direction(random),
          Quat(normal(random), normal(random), normal(random), normal(random)).normalized()};
}

ConvexShape random_polytope(std::mt19937_64& random) {
  const tests::Sizes size(random);
  if (random() % 3 == 0) return Box{0.5 * size.three()};
  return tests::random_polyhedron(size);
}

/// The highest separation found from many directions.
double highest_found(const ConvexCore& a, const ConvexCore& b, std::mt19937_64& random) {
  Peak best = climb(a, b, between_centres(a, b), search_resolution);
  for (int k = 0; k < 100; ++k) {
    const Peak peak = climb(a, b, tests::random_direction(random), 0.3);
    if (peak.core_gap > best.core_gap) best = peak;
  }
  return search_directions(a, b, best, 1e9)->core_gap;
}

TEST(PolytopeDepth, IsTheLeastOfAllDirections) {
  std::mt19937_64 random(5);
  int pairs = 0, edges = 0;
  while (pairs < 400) {
    const ConvexShape shape_a = random_polytope(random), shape_b = random_polytope(random);
    const Pose at_a = random_pose(random, 1000), from_a = random_pose(random, double(random() % 12));
    const Pose at_b{at_a.position + from_a.position, from_a.orientation};
    const ConvexCore a = convex_core(shape_a, at_a), b = convex_core(shape_b, at_b);
    if (gjk_direction(a, b, Vec3::Zero(), between_centres(a, b))) continue;
    ++pairs;
    ASSERT_TRUE(has_few_edges(a, b));
    const Peak peak = least_depth(a, b), turned = least_depth(b, a);
    const double scale = length_scale(a, b);
    EXPECT_NEAR(peak.normal.norm(), 1, 1e-14);
    EXPECT_NEAR(peak.core_gap, highest_found(a, b, random), 1e-11 * scale) << pairs;
    EXPECT_NEAR(peak.core_gap, turned.core_gap, 1e-12 * scale);
    const auto approach = deepest_direction(a, b, 0);
    ASSERT_TRUE(approach);
    EXPECT_EQ(approach->peak.core_gap, peak.core_gap);
    EXPECT_LT(approach->where.miss, 1e-10 * scale);
    Kinks of_a, of_b;
    a.kinks(peak.normal, 1e-9, of_a), b.kinks(-peak.normal, 1e-9, of_b);
    edges += of_a.faces.empty() && of_b.faces.empty();
  }
  EXPECT_GT(edges, 100) << "crossed edges are among the answers";
  EXPECT_LT(edges, 350) << "faces, too";
}

TEST(PolytopeDepth, NoEdgesBeatAFaceByRounding) {
  std::mt19937_64 random(6);
  const ConvexShape cube = Box{{1, 1, 1}};
  const ConvexCore a = convex_core(cube, {});
  const Quat twist(std::cos(0.2), 0, 0, std::sin(0.2));
  for (int k = 0; k < 100; ++k) {
    const Vec3 tilt = 1e-14 * tests::random_direction(random);
    const ConvexCore b =
        convex_core(cube, {{0, 0, 1.9}, (Quat(1, tilt[0], tilt[1], tilt[2]) * twist).normalized()});
    const Peak peak = least_depth(a, b);
    EXPECT_LT(std::min((peak.normal - a.axes.col(2)).norm(), (peak.normal - b.axes.col(2)).norm()), 1e-16);
    EXPECT_NEAR(peak.core_gap, -0.1, 1e-13);
  }
}

// The normal of edges nearly parallel is known badly: no depth that is not there must come of it.
TEST(PolytopeDepth, EdgesNearlyParallel) {
  std::mt19937_64 random(7);
  std::vector<Vec3> corners;
  for (int k = 0; k < 12; ++k)
    corners.emplace_back(std::cos(M_PI / 3 * k), std::sin(M_PI / 3 * k), k < 6 ? -0.5 : 0.5);
  const ConvexShape prism = tests::hull_of(corners);
  const ConvexCore a = convex_core(prism, {});
  for (const double depth : {1e-3, 1e-6, 1e-9})
    for (double tilt = 1e-4; tilt > 1e-16; tilt *= 0.97) {
      const Vec3 turn = tilt * tests::random_direction(random);
      const ConvexCore b =
          convex_core(prism, {{0, 0, 1 - depth}, Quat(1, turn[0], turn[1], turn[2]).normalized()});
      const Peak peak = least_depth(a, b);
      EXPECT_GE(peak.core_gap, core_separation(a, b, a.axes.col(2)) - 1e-15) << depth << " " << tilt;
      EXPECT_GE(peak.core_gap, core_separation(a, b, b.axes.col(2)) - 1e-15) << depth << " " << tilt;
    }
}

TEST(PolytopeDepth, IsForSolidPolytopesAlone) {
  const ConvexShape box = Box{{1, 2, 3}}, ball = Sphere{1}, capsule = Capsule{1, 1}, can = Cylinder{1, 1};
  const ConvexCore solid = convex_core(box, {});
  EXPECT_TRUE(has_few_edges(solid, solid));
  for (const ConvexShape& other : {ball, capsule, can}) {
    EXPECT_FALSE(has_few_edges(solid, convex_core(other, {})));
    EXPECT_FALSE(has_few_edges(convex_core(other, {}), solid));
  }
}

}  // namespace
}  // namespace silt::rigid

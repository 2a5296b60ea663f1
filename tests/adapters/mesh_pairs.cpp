// Pairs with a mesh on every backend: against the same shapes given analytically, against searches over all
// triangles, and backend against backend.
#include <gtest/gtest.h>

#include <cstring>

#include "adapters/automatic/collision_factory.hpp"
#include "tests/adapters/mesh_scenes.hpp"

namespace silt::tests {
namespace {

using adapters::make_backend;
using rigid::ContactPoint;
using rigid::TriangleMesh;
namespace meshes = rigid::testing;

class MeshPairs : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<rigid::CollisionBackend> backend_ = make_backend(GetParam());
  std::unique_ptr<rigid::CollisionBackend> analytic_ = make_backend("analytic");
};
INSTANTIATE_TEST_SUITE_P(On, MeshPairs, testing::Values("auto", "analytic", "bullet", "fcl"),
                         [](const auto& name) { return name.param; });

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// Every contact is sound if its points are gap apart along the normal, its features are in order.
void expect_sound(const Points& points) {
  for (std::size_t k = 0; k < points.size(); ++k) {
    const ContactPoint& p = points[k];
    EXPECT_NEAR(p.normal.norm(), 1, 1e-12);
    EXPECT_LE((p.on_b - p.on_a - p.gap * p.normal).norm(), 1e-11);
    if (k > 0) {
      EXPECT_LT(points[k - 1].feature, p.feature);
    }
  }
}

/// Deepest gap and normal are those of the box that the mesh is, however fine its faces are divided.
TEST_P(MeshPairs, ACuboidOfTrianglesIsABox) {
  constexpr int scenes = 12;
  for (const Kind kind : bodies())
    for (const bool apart : {true, false})
      for (const int n : {1, 3}) {
        std::mt19937_64 random(11);
        for (int i = 0; i < scenes; ++i) {
          const double u = uniform(random, 0, 1), gap = apart ? 0.9 * std::pow(10.0, -3 * u) : 1e-7 * u;
          const Pair p = random_pair(kind, "box", gap, random);
          const Points right = collide(*analytic_, p);
          const MeshFeatures mesh = features_of(tessellated_cuboid(std::get<rigid::Box>(p.b).half_edges, n));
          const Points found = collide_with(*backend_, p.a, p.pose_a, mesh, p.pose_b);
          ASSERT_FALSE(found.empty()) << kind << ' ' << i << ' ' << n;
          expect_sound(found);
          EXPECT_NEAR(deepest(found).gap, deepest(right).gap, 1e-9) << kind << ' ' << i << ' ' << n;
          EXPECT_LE((deepest(found).normal - deepest(right).normal).norm(), 1e-6) << kind << ' ' << i;
        }
      }
}

/// No body that overlaps by up to 2 cells in 100 is missed, and none is said to be much deeper than it is:
/// round ones have the depth of the box; for others that of one feature may be another than that of the
/// whole.
TEST_P(MeshPairs, OverlapsWithACuboidAreFound) {
  constexpr int scenes = 30;
  for (const Kind kind : bodies()) {
    std::mt19937_64 random(12);
    const bool round = kind == "sphere" || kind == "capsule" || kind == "ellipsoid";
    for (int i = 0; i < scenes; ++i) {
      const Pair p = random_pair(kind, "box", -0.02 * uniform(random, 0.05, 1), random);
      const Points right = collide(*analytic_, p);
      const MeshFeatures mesh = features_of(tessellated_cuboid(std::get<rigid::Box>(p.b).half_edges, 2));
      const Points found = collide_with(*backend_, p.a, p.pose_a, mesh, p.pose_b);
      ASSERT_FALSE(found.empty()) << kind << ' ' << i;
      expect_sound(found);
      const double times = deepest(found).gap / deepest(right).gap;
      EXPECT_GE(times, round ? 1 - 1e-9 : 0.9) << kind << ' ' << i;
      EXPECT_LE(times, round ? 1 + 1e-9 : 6) << kind << ' ' << i;
    }
  }
}

/// Bodies within a vessel of triangles touch it as they touch its six planes.
TEST_P(MeshPairs, AVesselIsSixHalfSpaces) {
  const Vec3 half(40, 50, 60);
  const MeshFeatures vessel = features_of(tessellated_cuboid(half, 4), true);
  const Pose pose_b{{1, 2, 3}, turned(20, {1, 2, 3})};
  std::mt19937_64 random(13);
  for (const Kind kind : bodies())
    for (int i = 0; i < 20; ++i) {
      const ConvexShape shape = random_shape(kind, random);
      Pose at{Vec3::Zero(), random_orientation(random)};
      const rigid::BoundingBox box = std::visit([&](const auto& s) { return s.bounding_box(at); }, shape);
      for (int d = 0; d < 3; ++d)
        at.position[d] = i >> d & 1 ? half[d] - box.upper[d] - 0.01 : -half[d] - box.lower[d] + 0.02;
      const Points found = collide_with(*backend_, shape, pose_b * at, vessel, pose_b, 0.05);
      expect_sound(found);
      std::array<double, 3> gap{1, 1, 1};
      for (const ContactPoint& p : found) {
        const Vec3 n = pose_b.orientation.conjugate() * p.normal;
        int d;
        EXPECT_NEAR(n.cwiseAbs().maxCoeff(&d), 1, 1e-9) << kind;
        EXPECT_EQ(n[d] > 0, (i >> d & 1) != 0) << kind;
        gap[d] = std::min(gap[d], p.gap);
      }
      for (int d = 0; d < 3; ++d) EXPECT_NEAR(gap[d], i >> d & 1 ? 0.01 : 0.02, 1e-9) << kind << ' ' << i;
    }
}

/// Not convex, and of curved shape: the contacts of a ball are the points of the surface that are nearest
/// to its centre, the first of them that of a search over all.
TEST_P(MeshPairs, BallsOnATorusMeetTheNearestPoint) {
  const MeshFeatures torus = features_of(meshes::torus_mesh(5, 2, 40, 20));
  std::mt19937_64 random(14);
  int met = 0;
  for (int i = 0; i < 500; ++i) {
    const double radius = uniform(random, 0.3, 3);
    const Pose at{8 * uniform(random, 0, 1) * random_direction(random), Quat::Identity()};
    const Points found = collide_with(*backend_, rigid::Sphere{radius}, at, torus, {}, 1);
    const auto nearest = torus.surface().nearest(at.position);
    const double gap = (torus.mesh().contains(at.position) ? -1 : 1) * nearest.distance - radius;
    ASSERT_EQ(found.empty(), gap > 1) << i;
    if (found.empty()) continue;
    ++met;
    expect_sound(found);
    EXPECT_NEAR(deepest(found).gap, gap, 1e-12);
    EXPECT_LE((deepest(found).on_b - nearest.point).norm(), 1e-9);
  }
  EXPECT_GT(met, 200);
}

/// A sphere of triangles against a sphere: within the height of its facets.
TEST_P(MeshPairs, ABallOfTrianglesIsNearlyABall) {
  const double radius = 5;
  const MeshFeatures ball = features_of(meshes::icosphere(radius, 4));
  double off = 0;
  for (std::uint32_t t = 0; t < ball.surface().triangles().size(); ++t)
    off = std::max(off, radius - ball.normal(t).dot(ball.surface().corners(t)[0]));
  std::mt19937_64 random(15);
  for (const Kind kind : {"sphere", "box", "capsule", "cylinder"})
    for (int i = 0; i < 20; ++i) {
      Pair p{random_shape(kind, random), rigid::Sphere{radius}, {}, {}};
      p.pose_a = {Vec3::Zero(), random_orientation(random)};
      p.pose_b = {40 * random_direction(random), random_orientation(random)};
      const ReferenceGap far = reference_gap(p);
      p.pose_b.position += (uniform(random, -0.1, 0.5) - far.gap) * far.normal;
      const Points right = collide(*analytic_, p);
      ASSERT_FALSE(right.empty());
      const Points found = collide_with(*backend_, p.a, p.pose_a, ball, p.pose_b, 1 + off);
      ASSERT_FALSE(found.empty()) << kind << ' ' << i;
      EXPECT_GE(deepest(found).gap, deepest(right).gap - 1e-9) << kind << ' ' << i;
      EXPECT_LE(deepest(found).gap, deepest(right).gap + off + 1e-9) << kind << ' ' << i;
      if (kind == "sphere") {
        EXPECT_EQ(found.size(), 1u) << "outside of what is convex one point is nearest";
      }
    }
}

/// Two meshes as the two boxes they are, face on face too.
TEST_P(MeshPairs, TwoMeshesMeetAsTwoBoxes) {
  const auto faces = [&](const Pair& p) {
    const auto mesh = [](const ConvexShape& s) {
      return features_of(tessellated_cuboid(std::get<rigid::Box>(s).half_edges, 2));
    };
    Points found;
    rigid::append_mesh_contacts({mesh(p.a), p.pose_a}, {mesh(p.b), p.pose_b}, 1, *backend_, found);
    return found;
  };
  std::mt19937_64 random(16);
  for (int i = 0; i < 20; ++i) {
    const Pair p = random_pair("box", "box", 0.5 * std::pow(10.0, -6 * uniform(random, 0, 1)), random);
    const Points found = faces(p), right = collide(*analytic_, p);
    ASSERT_FALSE(found.empty()) << i;
    EXPECT_NEAR(deepest(found).gap, deepest(right).gap, 1e-9) << i;
  }
  for (const double gap : {0.01, 0.0, -0.01}) {
    const Pair p = stacked_boxes({2, 1, 2}, {0.3, 0.2, 0}, 17, gap);
    const Points found = faces(p), right = collide(*analytic_, p);
    EXPECT_EQ(found.size(), right.size());
    for (const ContactPoint& q : right)
      EXPECT_TRUE(std::any_of(found.begin(), found.end(), [&](const ContactPoint& f) {
        return (f.on_a - q.on_a).norm() + (f.on_b - q.on_b).norm() < 1e-9;
      }));
    for (const ContactPoint& f : found) EXPECT_NEAR((f.normal - Vec3::UnitZ()).norm(), 0, 1e-12);
  }
}

/// Corners of a mesh against a plane and in a tube: the least gap of all its corners.
TEST_P(MeshPairs, PlanesAndTubesMeetTheFurthestCorners) {
  const MeshFeatures gear = features_of(meshes::gear_mesh(9, 2));
  std::mt19937_64 random(17);
  for (int i = 0; i < 50; ++i) {
    const Pose at{random_direction(random), random_orientation(random)},
        wall{0.9 * random_direction(random), random_orientation(random)};
    double to_plane = 1e9, to_tube = 1e9;
    const rigid::HalfSpace plane{Vec3::UnitX()};
    const rigid::Tube tube{1.5};
    for (const Vec3& v : gear.surface().vertices()) {
      const Vec3 x = wall.to_body(at.to_world(v));
      to_plane = std::min(to_plane, x[0]);
      to_tube = std::min(to_tube, tube.signed_distance(x));
    }
    Points on_plane, in_tube;
    rigid::append_mesh_contacts({gear, at}, plane, wall, 0.3, on_plane);
    rigid::append_mesh_contacts({gear, at}, tube, wall, 0.3, in_tube);
    ASSERT_EQ(on_plane.empty(), to_plane > 0.3);
    ASSERT_EQ(in_tube.empty(), to_tube > 0.3);
    expect_sound(on_plane);
    expect_sound(in_tube);
    if (!on_plane.empty()) {
      EXPECT_NEAR(deepest(on_plane).gap, to_plane, 1e-12);
    }
    if (!in_tube.empty()) {
      EXPECT_NEAR(deepest(in_tube).gap, to_tube, 1e-12);
    }
  }
}

/// Whichever tree is asked, the contacts are those without one, to the bit.
TEST(MeshTrees, EveryEngineGivesTheSameBits) {
  const MeshFeatures torus = features_of(meshes::torus_mesh(5, 2, 30, 15)),
                     gear = features_of(meshes::gear_mesh(9, 2));
  const auto own = make_backend("analytic");
  std::vector<std::unique_ptr<rigid::CollisionBackend>> engines;
  for (const char* name : {"auto", "bullet", "fcl"}) engines.push_back(make_backend(name));
  std::size_t met = 0;
  const auto expect_same = [&](const auto& contacts_by) {
    const Points right = contacts_by(*own);
    met += right.size();
    for (const auto& engine : engines) {
      const Points found = contacts_by(*engine);
      ASSERT_EQ(found.size(), right.size()) << engine->name();
      for (std::size_t k = 0; k < found.size(); ++k)
        EXPECT_EQ(std::memcmp(&found[k], &right[k], sizeof found[k]), 0) << engine->name();
    }
  };
  std::mt19937_64 random(18);
  const Pose pose_b{{100, 200, 300}, random_orientation(random)};
  for (int i = 0; i < 20; ++i) {
    const Pose at{pose_b.position + 10 * random_direction(random), random_orientation(random)};
    for (const Kind kind : bodies()) {
      const ConvexShape shape = random_shape(kind, random);
      expect_same([&](auto& backend) { return collide_with(backend, shape, at, torus, pose_b); });
    }
    expect_same([&](auto& backend) {
      Points found;
      rigid::append_mesh_contacts({gear, at}, {torus, pose_b}, 0.5, backend, found);
      return found;
    });
  }
  EXPECT_GT(met, 150u);
  for (const auto& engine : engines) {
    EXPECT_GT(engine->counters().queries, 100u) << engine->name();
    EXPECT_EQ(engine->counters().answered, engine->counters().queries) << engine->name();
  }
}

}  // namespace
}  // namespace silt::tests

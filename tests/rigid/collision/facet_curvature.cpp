// Curvature from the angles between facets, against that of the smooth surfaces they stand for; and the gaps
// that lubrication sees on such surfaces, against those on the smooth ones.
#include "rigid/collision/mesh_features.hpp"

#include <gtest/gtest.h>

#include "tests/rigid/scene.hpp"
#include "tests/rigid/shapes/meshes.hpp"

namespace silt::rigid {
namespace {

using testing::Scene;

using std::numbers::pi;

/// Principal curvatures, ascending, of which that along the normal, zero, is taken out.
std::array<double, 2> principal(const Mat3& k, const Vec3& normal) {
  EXPECT_LT((k * normal).norm(), 1e-9 * (1 + k.norm()));
  const Vec3 x = normal.unitOrthogonal(), y = normal.cross(x);
  const double xx = x.dot(k * x), xy = x.dot(k * y), yy = y.dot(k * y);
  const double mean = 0.5 * (xx + yy), apart = std::hypot(0.5 * (xx - yy), xy);
  return {mean - apart, mean + apart};
}

Mat3 at_triangle(const MeshFeatures& mesh, const FacetCurvature& curvature, std::uint32_t triangle) {
  return curvature.at(mesh.code_of_facet(triangle)).value();
}

TEST(FacetCurvature, IsThatOfACylinderAndOfTheHollowInIt) {
  for (const bool hollow : {false, true}) {
    const auto shape = testing::prism_mesh(3, 5, 60);
    const MeshFeatures mesh(hollow ? testing::vessel_of(shape) : testing::solid_of(shape));
    const FacetCurvature curvature(mesh);
    for (std::uint32_t t = 0; t < mesh.surface().triangles().size(); ++t) {
      const Vec3 n = mesh.normal(t);
      const auto [least, largest] = principal(at_triangle(mesh, curvature, t), n);
      const double around = std::abs(n.z()) > 0.5 ? 0 : hollow ? -1. / 3 : 1. / 3;  // the ends are flat
      EXPECT_NEAR(least, std::min(around, 0.0), 1e-3) << t;
      EXPECT_NEAR(largest, std::max(around, 0.0), 1e-3) << t;
    }
  }
}

TEST(FacetCurvature, IsThatOfASphereOnAverageAndNearItEverywhere) {
  const MeshFeatures mesh(testing::solid_of(testing::icosphere(2, 4)));
  const FacetCurvature curvature(mesh);
  double sum = 0;
  const auto count = static_cast<std::uint32_t>(mesh.surface().triangles().size());
  for (std::uint32_t t = 0; t < count; ++t) {
    const auto [least, largest] = principal(at_triangle(mesh, curvature, t), mesh.normal(t));
    EXPECT_NEAR(least, 0.5, 0.12);
    EXPECT_NEAR(largest, 0.5, 0.12);
    sum += 0.5 * (least + largest) / count;
  }
  EXPECT_NEAR(sum, 0.5, 0.005);
}

TEST(FacetCurvature, HasBothSignsInsideATorus) {
  constexpr double radius = 3, tube = 1;
  const MeshFeatures mesh(testing::solid_of(testing::torus_mesh(radius, tube, 240, 80)));
  const FacetCurvature curvature(mesh);
  for (std::uint32_t t = 0; t < mesh.surface().triangles().size(); ++t) {
    const auto corners = mesh.surface().corners(t);
    const Vec3 middle = (corners[0] + corners[1] + corners[2]) / 3;
    const double rho = std::hypot(middle.x(), middle.y());
    const auto [least, largest] = principal(at_triangle(mesh, curvature, t), mesh.normal(t));
    EXPECT_NEAR(largest, 1 / tube, 0.03);
    EXPECT_NEAR(least, (rho - radius) / tube / rho, 0.03) << rho;
  }
}

TEST(FacetCurvature, EndsAtCreases) {
  const MeshFeatures mesh(testing::solid_of(testing::cuboid_mesh({-1, -1, -1}, {1, 1, 1})));
  const FacetCurvature curvature(mesh);
  for (std::uint32_t t = 0; t < 12; ++t) EXPECT_EQ(at_triangle(mesh, curvature, t), Mat3::Zero());
  for (std::uint32_t v = 0; v < 8; ++v) EXPECT_FALSE(curvature.at(mesh.code_of_corner(v)));
  int flat = 0;
  for (std::uint32_t e = 0; e < mesh.edge_count(); ++e)
    flat += curvature.at(mesh.code_of_edge(e)).has_value();
  EXPECT_EQ(flat, 6);  // the diagonals of the sides
}

/// Keeps the gaps that it is asked about.
class Listener final : public LubricationLaw {
 public:
  double reach() const override { return 0.5; }
  LubricationResistance operator()(const LubricatedGap& gap) const override {
    heard.push_back(gap);
    return {1, 0, 0};
  }
  mutable std::vector<LubricatedGap> heard;
};

/// The gaps of a ball of radius 1 at x with a wall.
std::vector<LubricatedGap> gaps_with(const Vec3& x, const std::function<void(Scene&)>& add_wall) {
  Scene s(0, 0);
  const auto law = std::make_shared<Listener>();
  s.world.lubrication = law;
  s.add(s.shape(Sphere{1}), x);
  add_wall(s);
  s.start();
  std::vector<Contact> contacts;
  DetectContacts detect;
  detect(s.world, s.bodies, *s.exchange, *s.backend, 1e-3, contacts);
  EXPECT_EQ(detect.lubrication().with, law->heard.size());
  return law->heard;
}

void add_mesh(Scene& s, const Mesh& mesh, const Vec3& x) {
  add_wall(s.bodies, s.world, {mesh, {x, Quat::Identity()}, Vec3::UnitZ(), 0, {}});
}

TEST(GapsAtMeshes, AreOneOnAPlaneHoweverItIsDivided) {
  const Mesh slab = testing::solid_of(testing::random_slab(10, 4, 12, 5));
  for (int k = 0; k < 50; ++k) {
    const auto gaps = gaps_with({48 + 0.0713 * k, 49 + 0.0317 * k, 51.2}, [&](Scene& s) {
      add_mesh(s, slab, {45, 45, 50});
    });
    ASSERT_EQ(gaps.size(), 1u) << k;
    EXPECT_NEAR(gaps[0].width, 0.2, 1e-12);
    EXPECT_NEAR(gaps[0].curvature_sum(), 2, 1e-9);
    EXPECT_NEAR(gaps[0].curvature_product(), 1, 1e-9);
  }
}

/// In a pipe of 60 facets, over their middles, seams and all between: one gap, as in the round one.
TEST(GapsAtMeshes, AreOneInAPipeOfFacetsAsInATube) {
  constexpr double radius = 4, gap = 0.1;
  const Mesh pipe = testing::vessel_of(testing::prism_mesh(radius, 6, 60));
  for (int k = 0; k < 60; ++k) {
    const double angle = 2 * pi * k / 60 / 15;
    const Vec3 x = Vec3(50, 50, 50) + (radius - 1 - gap) * Vec3(std::cos(angle), std::sin(angle), 0.01);
    const auto of_facets = gaps_with(x, [&](Scene& s) { add_mesh(s, pipe, {50, 50, 50}); });
    const auto of_tube = gaps_with(x, [&](Scene& s) {
      add_wall(s.bodies, s.world, {Tube{radius}, {50, 50, 50}, Vec3::UnitZ(), 0, 0});
    });
    ASSERT_EQ(of_facets.size(), 1u) << k;
    ASSERT_EQ(of_tube.size(), 1u) << k;
    EXPECT_NEAR(of_tube[0].curvature_sum(), 2 - 1 / radius, 1e-12);
    EXPECT_NEAR(of_tube[0].curvature_product(), 1 - 1 / radius, 1e-12);
    EXPECT_NEAR(of_facets[0].width, of_tube[0].width, 0.01);
    EXPECT_NEAR(of_facets[0].curvature_sum(), of_tube[0].curvature_sum(), 2e-3);
    EXPECT_NEAR(of_facets[0].curvature_product(), of_tube[0].curvature_product(), 2e-3);
  }
}

TEST(GapsAtMeshes, AreNoneAtAnEdge) {
  const Mesh block = testing::solid_of(testing::cuboid_mesh({-5, -5, -5}, {5, 5, 5}));
  const auto add = [&](Scene& s) { add_mesh(s, block, {50, 50, 50}); };
  const double out = std::sqrt(0.5) * 1.1;
  EXPECT_EQ(gaps_with({55 + out, 50, 55 + out}, add).size(), 0u);
  EXPECT_EQ(gaps_with({54, 50, 56.1}, add).size(), 1u);
}

}  // namespace
}  // namespace silt::rigid

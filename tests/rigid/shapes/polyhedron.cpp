// The mesh of a convex polyhedron: what it is made of, and what is refused.
#include "rigid/shapes/polyhedron.hpp"

#include <gtest/gtest.h>

#include <set>

#include "rigid/rigid_step.hpp"
#include "tests/rigid/shapes/solids.hpp"

namespace silt::rigid {
namespace {

TEST(Polyhedron, FacesEdgesAndNeighboursOfACuboid) {
  const auto mesh = testing::cuboid({1, 2, 3}, {2, 4, 7}).mesh;
  ASSERT_EQ(mesh->faces.size(), 6u);
  ASSERT_EQ(mesh->edges.size(), 12u);
  std::set<std::array<int, 2>> seen;
  for (const auto& edge : mesh->edges) {
    EXPECT_TRUE(
        seen.insert({std::min(edge.corners[0], edge.corners[1]), std::max(edge.corners[0], edge.corners[1])})
            .second);
    const Vec3 along = mesh->vertices[edge.corners[1]] - mesh->vertices[edge.corners[0]];
    for (const int f : edge.faces) EXPECT_EQ(mesh->faces[f].normal.dot(along), 0);
    // counter-clockwise in the first, clockwise in the second face
    const Vec3 outward = along.cross(mesh->faces[edge.faces[0]].normal);
    EXPECT_GT(outward.dot(mesh->faces[edge.faces[1]].normal), 0.5);
  }
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(mesh->neighbours[i].size(), 3u);
  for (const auto& face : mesh->faces) {
    EXPECT_DOUBLE_EQ(face.normal.norm(), 1);
    EXPECT_LT(face.normal.dot(Vec3(1.5, 3, 5)), face.offset);
    for (const int c : face.corners) EXPECT_DOUBLE_EQ(face.normal.dot(mesh->vertices[c]), face.offset);
  }
  const auto moved = shifted(*mesh, {1, 1, 1});
  for (const auto& face : moved->faces)
    for (const int c : face.corners) EXPECT_DOUBLE_EQ(face.normal.dot(moved->vertices[c]), face.offset);
}

std::string refusal(std::vector<Vec3> corners, std::vector<std::vector<int>> faces) {
  try {
    make_polyhedron_mesh(std::move(corners), faces);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Polyhedron, RefusesWhatIsNone) {
  const auto corners = testing::hexahedron_corners({0, 0, 0}, {1, 1, 1});
  const auto faces = testing::hexahedron_faces();
  EXPECT_EQ(refusal(corners, faces), "");
  EXPECT_EQ(refusal({{0, 0, 0}, {1, 0, 0}}, {}), "polyhedron: it needs at least 4 corners and 4 faces");

  auto open = faces;
  open.pop_back();
  EXPECT_EQ(refusal(corners, open),
            "polyhedron: it is not closed: only one face has the edge from corner 4 to 6");
  auto inside_out = faces;
  for (auto& loop : inside_out) std::reverse(loop.begin(), loop.end());
  EXPECT_EQ(refusal(corners, inside_out),
            "polyhedron: its faces are clockwise seen from outside, or it has no volume");
  auto one_turned = faces;
  std::reverse(one_turned[0].begin(), one_turned[0].end());
  EXPECT_EQ(refusal(corners, one_turned),
            "polyhedron: two faces run the same way along the edge from corner 4");
  auto bent = corners;
  bent[7] = {1.1, 1, 1};
  EXPECT_EQ(refusal(bent, faces), "polyhedron: face 1 is not flat at corner 1");
  auto spare = corners;
  spare.push_back({0.5, 0.5, 0.5});
  EXPECT_EQ(refusal(spare, faces), "polyhedron: corner 8 belongs to no face");
  auto wild = faces;
  wild[2][1] = 9;
  EXPECT_EQ(refusal(corners, wild), "polyhedron: face 2 names corner 9, which is not there");
  // a pyramid whose tip is pushed in beyond its base: closed, each face flat, but not convex
  EXPECT_EQ(refusal({{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}, {0.3, 0.3, 0.3}},
                    {{0, 2, 1}, {0, 1, 3}, {2, 0, 3}, {1, 2, 4}, {2, 3, 4}, {3, 1, 4}}),
            "polyhedron: it is not convex: corner 3 lies outside face 3");
}

TEST(Polyhedron, NearestCornerNeedNotBelongToTheFurthestPlane) {
  // a steep pyramid, one edge of its side cut off below by a plane that is less steep than the sides: high
  // above the tip this plane is the furthest, but its face does not reach the tip
  const Vec3 tip(0, 0, 10), a(2, 0, 0), b(-1, 1.7, 0), c(-1, -1.7, 0);
  const double cut = 0.2 / 3;
  const Polyhedron obelisk{
      make_polyhedron_mesh({tip, 0.5 * (tip + a), a + cut * (b - a), a + cut * (c - a), b, c},
                           {{0, 1, 2, 4}, {0, 4, 5}, {0, 5, 3, 1}, {1, 3, 2}, {2, 3, 5, 4}})};
  const Vec3 x(0, 0, 20);
  double furthest = 0;
  int face = -1;
  for (int f = 0; f < 5; ++f) {
    const auto& plane = obelisk.mesh->faces[f];
    if (const double height = plane.normal.dot(x) - plane.offset; height > furthest)
      furthest = height, face = f;
  }
  ASSERT_EQ(face, 3);
  EXPECT_DOUBLE_EQ(signed_distance(obelisk, x), 10);
}

TEST(Polyhedron, TurnsLikeItsPrincipalAxesSay) {
  // the corner of a cube has off-diagonal inertia; about its principal axes the same motion is Euler's
  const auto p = mass_properties(testing::tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1.4, 0}, {0, 0, 1.9}));
  ASSERT_GT(std::abs(p.inertia(0, 1)), 0.05 * p.inertia(0, 0));
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(p.inertia);
  Mat3 axes = eigen.eigenvectors();
  if (axes.determinant() < 0) axes.col(0) *= -1;
  const Mat3 diagonal = eigen.eigenvalues().asDiagonal();
  const Vec3 momentum(0.01, -0.02, 0.03);
  Quat full = Quat::Identity(), principal = Quat(axes);
  for (int step = 0; step < 500; ++step) {
    full = free_rotation(full, p.inertia, momentum, 0.05);
    principal = free_rotation(principal, diagonal, momentum, 0.05);
  }
  EXPECT_LT((full.toRotationMatrix() * axes - principal.toRotationMatrix()).norm(), 1e-11);
  EXPECT_GT((full.toRotationMatrix() - Mat3::Identity()).norm(), 0.1) << "it has turned";
}

}  // namespace
}  // namespace silt::rigid

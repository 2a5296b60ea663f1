// Rest, sliding, rolling, rocking and toppling of cylinders, ellipsoids and polyhedra against closed forms.
// g = 9.81, dt = 1e-3.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "rigid/math/types.hpp"
#include "tests/hull_of.hpp"
#include "tests/rigid/with_backend.hpp"

namespace silt::rigid {
namespace {

using testing::Scene;

using testing::g;

Vec3 slope(double angle) {  // falling along +x
  return g * Vec3(std::sin(angle), 0, -std::cos(angle));
}

class RoundBodies : public testing::WithBackend {};

class FacetedBodies : public testing::WithBackend {};

/// One body over a floor; its id is 0.
Scene alone(const Shape& shape, double friction, const Vec3& gravity, double height,
            const Quat& q = Quat::Identity(), const Vec3& v = Vec3::Zero()) {
  Scene s(0, friction);
  s.world.gravity = gravity;
  s.add_with_id(0, s.shape(shape), {{10, 10, height}, q}, v);
  s.floor();
  s.start();
  return s;
}

const Quat lying(Eigen::AngleAxisd(M_PI / 2, Vec3::UnitX()));  // the axis along y

/// Shapes that lie on a face or a flat pole, their centre so high, stay where they are.
void expect_rest(const Shape& shape, double height, const Quat& orientation = Quat::Identity()) {
  Scene s = alone(shape, 0.5, slope(0), height, orientation);
  s.run(5000);
  EXPECT_LT((s.x(0) - Vec3(10, 10, height)).norm(), 1e-9) << shape_name(shape);
  EXPECT_LT(s.v(0).norm() + s.w(0).norm(), 1e-9) << shape_name(shape);
}

TEST_F(RoundBodies, RestOnTheirEnds) {
  expect_rest(Cylinder{0.4, 0.5}, 0.5);
  expect_rest(Ellipsoid{{0.6, 0.5, 0.3}}, 0.3);
}

/// A shape topples on a slope where its centre is beyond the edge, which is so far from the centre's foot.
void expect_topples(const Shape& shape, double height, double edge,
                    const Quat& orientation = Quat::Identity()) {
  for (double share : {0.97, 1.03}) {
    Scene s = alone(shape, 3, slope(share * std::atan(edge / height)), height, orientation);
    s.run(1000);
    EXPECT_EQ(s.w(0).norm() > 0.02, share > 1)
        << shape_name(shape) << ", " << share << ", omega " << s.w(0).norm();
  }
}

TEST_F(RoundBodies, ToppleAtTheRightAngle) {
  expect_topples(Cylinder{0.2, 0.5}, 0.5, 0.2);
}

TEST_F(RoundBodies, CylinderOnAnInclineSticksOrSlides) {
  for (double degrees : {20.0, 30.0}) {
    const double a = degrees * M_PI / 180;
    Scene s = alone(Cylinder{0.5, 0.2}, 0.5, slope(a), 0.2);
    s.run(1000);
    const double expected = degrees < 26 ? 0 : 0.5 * g * (std::sin(a) - 0.5 * std::cos(a));
    EXPECT_NEAR(s.x(0)[0] - 10, expected, 1e-6) << degrees;
    EXPECT_LT(s.w(0).norm(), 1e-6);
  }
}

TEST_F(RoundBodies, CylinderSlidesThenRolls) {  // t = v0 / (3 mu g), then v = 2/3 v0
  const double v0 = 1, mu = 0.2, r = 0.2;
  Scene s = alone(Cylinder{r, 0.5}, mu, slope(0), r, lying, {v0, 0, 0});
  double rolls = 0;
  for (int i = 1; i <= 400; ++i) {
    s.run(1);
    if (rolls == 0 && std::abs(s.v(0)[0] - r * s.w(0)[1]) < 1e-6) rolls = 1e-3 * i;
  }
  EXPECT_NEAR(rolls, v0 / (3 * mu * g), 1e-3);
  EXPECT_NEAR(s.v(0)[0], 2.0 / 3 * v0, 1e-6);
}

/// The mean of two periods of what velocity() swings through 0.
template <class F>
double period_of(Scene& s, F&& velocity) {
  std::vector<double> turns;  // half periods
  double before = 0;
  for (int i = 1; i <= 10000 && turns.size() < 5; ++i) {
    s.run(1);
    const double now = velocity();
    if (i > 5 && before * now < 0) turns.push_back(1e-3 * (i - now / (now - before)));
    before = now;
  }
  return turns.size() == 5 ? (turns[4] - turns[0]) / 2 : NAN;
}

TEST_F(RoundBodies, EllipsoidRocks) {
  // The centre is at sqrt(c^2 cos^2 + a^2 sin^2) over the plane: omega^2 = g (a^2 / c - c) / (I / m + c^2).
  const double a = 0.6, c = 0.3, tilt = 0.02;
  const double height = std::hypot(c * std::cos(tilt), a * std::sin(tilt));
  Scene s = alone(Ellipsoid{{a, 0.5, c}}, 1, slope(0), height, Quat(Eigen::AngleAxisd(tilt, Vec3::UnitY())));
  const double period = 2 * M_PI * std::sqrt(((a * a + c * c) / 5 + c * c) / (g * (a * a / c - c)));
  EXPECT_NEAR(period_of(s, [&] { return s.w(0)[1]; }) / period, 1, 2e-3);  // amplitude: 1e-4, a step: 1e-3
}

Polyhedron octahedron() {
  return tests::hull_of({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}});
}

Polyhedron dodecahedron() {
  const double p = 0.5 * (1 + std::sqrt(5.0));
  std::vector<Vec3> corners;
  for (double i : {-1.0, 1.0})
    for (double j : {-1.0, 1.0}) {
      for (double k : {-1.0, 1.0}) corners.push_back({i, j, k});
      corners.push_back({0, i / p, j * p});
      corners.push_back({i / p, j * p, 0});
      corners.push_back({i * p, 0, j / p});
    }
  return tests::hull_of(corners);
}

Polyhedron irregular() {  // on a sphere, so that all are corners
  std::mt19937 random(11);
  std::normal_distribution<> u;
  std::vector<Vec3> corners;
  for (int i = 0; i < 12; ++i) corners.push_back(Vec3(u(random), u(random), u(random)).normalized());
  const Polyhedron hull = tests::hull_of(corners);
  return std::get<Polyhedron>(recentred(hull, mass_properties(hull).centre));
}

Polyhedron hexagonal_prism(double radius, double half_height) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 6; ++i)
    for (double z : {-half_height, half_height})
      corners.push_back({radius * std::cos(i * M_PI / 3), radius * std::sin(i * M_PI / 3), z});
  return tests::hull_of(corners);
}

/// The way to lie on the lowest face, with the edge nearest below the centre towards +x; and when it topples.
struct Lying {
  Quat orientation;
  double height = 1e300, edge = 1e300;  // of the centre over the face; of its foot to that edge
};

Lying on_lowest_face(const Polyhedron& p) {
  Lying best;
  const PolyhedronMesh::Face* face = nullptr;
  for (const auto& f : p.mesh->faces)
    if (f.offset < best.height) best.height = f.offset, face = &f;
  Vec3 outward = Vec3::Zero();
  for (std::size_t i = 0; i < face->corners.size(); ++i) {
    const Vec3 &a = p.mesh->vertices[face->corners[i]],
               &b = p.mesh->vertices[face->corners[(i + 1) % face->corners.size()]];
    const Vec3 out = (b - a).cross(face->normal).normalized();
    if (out.dot(a) < best.edge) best.edge = out.dot(a), outward = out;
  }
  Mat3 from;  // columns: what is to be x, y, z
  from << outward, -face->normal.cross(outward), -face->normal;
  best.orientation = Quat(Mat3(from.transpose())).normalized();
  return best;
}

TEST_F(FacetedBodies, RestOnAFaceAndToppleAtTheRightAngle) {
  for (const Polyhedron& p : {octahedron(), dodecahedron(), irregular(), hexagonal_prism(0.5, 0.5)}) {
    SCOPED_TRACE(std::to_string(p.mesh->faces.size()) + " faces");
    const Lying l = on_lowest_face(p);
    ASSERT_GT(l.edge, 0);
    expect_rest(p, l.height, l.orientation);
    expect_topples(p, l.height, l.edge, l.orientation);
  }
}

/// Turned against one another they have twelve corners a contact, of which eight are kept.
TEST_F(FacetedBodies, StacksOfPrismsComeToRest) {
  for (const auto& [turn, moved] : {std::pair(0.0, 1e-4), {0.2, 2e-4}}) {
    Scene s(0, 0.5);
    s.world.gravity = slope(0);
    const int prism = s.shape(hexagonal_prism(0.5, 0.25));
    std::array<Vec3, 5> settled;
    for (int i = 0; i < 5; ++i)
      s.add_with_id(i, prism, {{10, 10, 0.25 + 0.5 * i}, Quat(Eigen::AngleAxisd(turn * i, Vec3::UnitZ()))});
    s.floor();
    s.start();
    s.run(2000);
    for (int i = 0; i < 5; ++i) settled[i] = s.x(i);
    s.run(2000);
    for (int i = 0; i < 5; ++i) {
      EXPECT_LT((settled[i] - Vec3(10, 10, 0.25 + 0.5 * i)).norm(), moved)
          << "while the weight is shared out";
      EXPECT_LT((s.x(i) - settled[i]).norm(), 1e-8) << turn << ", " << i;
      EXPECT_LT(s.v(i).norm() + s.w(i).norm(), 1e-8) << turn << ", " << i;
    }
  }
}

}  // namespace
}  // namespace silt::rigid

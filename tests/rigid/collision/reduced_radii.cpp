// The reduced radii of contacts: those of the surfaces where they touch, whatever the bodies' sizes.
#include <gtest/gtest.h>

#include "rigid/collision/detect_contacts.hpp"
#include "tests/rigid/scene.hpp"
#include "tests/rigid/shapes/meshes.hpp"
#include "tests/rigid/shapes/solids.hpp"

namespace silt::rigid::testing {
namespace {

const Vec3 middle = Vec3::Constant(50);
constexpr double gap = 0.01;

struct Placed {
  Shape shape;
  Vec3 x = Vec3::Zero();  // from the middle
  Quat q = Quat::Identity();
  Motion motion = Motion::free;
};

Scene scene_of(const std::vector<Placed>& bodies) {
  Scene s(0, 0);
  s.world.materials[0].rolling_friction = 0.1;
  for (const Placed& body : bodies) {
    const BodyId id = s.add(s.shape(body.shape), middle + body.x);
    s.bodies.orientation[s.row(id)] = body.q;
    s.bodies.motion[s.row(id)] = body.motion;
  }
  return s;
}

std::vector<Contact> contacts_in(Scene& s) {
  s.start();
  s.world.materials[0].hamaker = 1, s.world.materials[0].hamaker_gap = gap;  // seen from ten times that
  std::vector<Contact> contacts;
  DetectContacts detect;
  detect(s.world, s.bodies, *s.exchange, *s.backend, 1e-3, contacts);
  return contacts;
}

std::vector<Contact> contacts_of(const std::vector<Placed>& bodies) {
  Scene s = scene_of(bodies);
  return contacts_in(s);
}

void expect_radii(const std::vector<Contact>& contacts, double least, double largest, double share = 1e-12) {
  ASSERT_FALSE(contacts.empty());
  for (const Contact& c : contacts) {
    EXPECT_NEAR(c.radii.least, least, share * least);
    EXPECT_NEAR(c.radii.largest, largest, share * largest);
  }
}

const Quat upside_down = Quat(Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitX()));

/// Bodies whose upper face is flat and at the middle.
std::vector<Placed> plates() {
  std::vector<Placed> all;
  for (const double thick : {0.02, 0.5, 4.0}) {
    const Vec3 half(5, 6, thick / 2), below(0.3, -0.2, -thick / 2);
    all.push_back({Box{half}, below});
    all.push_back({cuboid(-half, half), below});
    all.push_back({solid_of(cuboid_mesh(-half, half)), below});
    all.push_back({Cylinder{5, thick / 2}, below});
  }
  return all;
}

TEST(ReducedRadii, OfABallOnAFlatFaceAreTheBalls) {
  constexpr double radius = 0.7;
  for (Placed plate : plates())
    for (const Motion motion : {Motion::free, Motion::fixed})
      for (const double apart : {gap, 0.0, -1e-3}) {
        SCOPED_TRACE(shape_name(plate.shape));
        plate.motion = motion;
        expect_radii(contacts_of({{Sphere{radius}, {0, 0, radius + apart}}, plate}), radius, radius);
        expect_radii(contacts_of({plate, {Sphere{radius}, {0, 0, radius + apart}}}), radius, radius);
      }
  Scene s(0, 0);
  s.world.materials[0].rolling_friction = 0.1;
  s.add(s.shape(Sphere{radius}), {50, 50, radius + gap});
  s.floor();
  expect_radii(contacts_in(s), radius, radius, 0);
}

/// Of a ball beside an ellipsoid, a rod and in a drum; of two balls.
TEST(ReducedRadii, OfABallOnACurvedSurface) {
  constexpr double r = 0.7;
  const auto beside = [](double k) { return 1 / (1 / r + k); };
  expect_radii(contacts_of({{Sphere{r}}, {Sphere{2}, {0, 0, r + 2 + gap}}}), beside(0.5), beside(0.5));
  for (const Shape& rod : {Shape(Cylinder{2, 3}), Shape(Capsule{2, 3})})
    expect_radii(contacts_of({{Sphere{r}}, {rod, {r + 2 + gap, 0, 0.4}}}), beside(0.5), r);
  expect_radii(contacts_of({{Sphere{r}}, {Capsule{2, 3}, {0, 0, r + 5 + gap}}}), beside(0.5), beside(0.5));
  // principal radii at the end of the axis c: a^2 / c, b^2 / c
  expect_radii(contacts_of({{Sphere{r}}, {Ellipsoid{{3, 1, 2}}, {0, 0, r + 2 + gap}}}), beside(2 / 1.),
               beside(2 / 9.), 1e-9);
  Scene s(0, 0);
  s.world.materials[0].rolling_friction = 0.1;
  s.add(s.shape(Sphere{r}), middle + Vec3(2 - r - gap, 0, 0));
  add_wall(s.bodies, s.world, {Tube{2}, middle, Vec3::UnitZ(), 0, 0});
  expect_radii(contacts_in(s), r, beside(-0.5));
}

/// Rods whose axes make an angle: sqrt(R1 R2) / sine (J. Israelachvili, Intermolecular and Surface Forces).
TEST(ReducedRadii, OfCrossedRodsHaveDerjaguinsMean) {
  for (const double angle : {0.3, 0.8, std::numbers::pi / 2}) {
    const Quat along_x = rotation_between(Vec3::UnitZ(), Vec3::UnitX());
    const Quat aside = rotation_between(Vec3::UnitZ(), Vec3(std::cos(angle), std::sin(angle), 0));
    for (const auto& [a, b] :
         {std::pair<Shape, Shape>{Cylinder{0.5, 4}, Cylinder{2, 8}}, {Capsule{0.5, 4}, Cylinder{2, 8}}}) {
      const auto contacts =
          contacts_of({{a, {0, 0, 2.5 + gap}, along_x}, {b, Vec3::Zero(), aside, Motion::fixed}});
      ASSERT_EQ(contacts.size(), 1u);
      const auto [least, largest] = contacts[0].radii;
      EXPECT_NEAR(std::sqrt(least * largest), std::sqrt(0.5 * 2) / std::sin(angle), 1e-6);
      if (angle > 1.5) {
        EXPECT_NEAR(least, 0.5, 1e-9);
      }
    }
  }
}

/// Lines and faces: of the round side, of the height above a plate however thick that is.
TEST(ReducedRadii, OfWhatLiesFlat) {
  const Quat lying = rotation_between(Vec3::UnitZ(), Vec3::UnitY());
  for (Placed plate : plates()) {
    SCOPED_TRACE(shape_name(plate.shape));
    plate.motion = Motion::fixed;
    expect_radii(contacts_of({{Cylinder{0.4, 1}, {0, 0, 0.4}, lying}, plate}), 0.4, 0.4, 1e-9);
    expect_radii(contacts_of({{Capsule{0.4, 1}, {0, 0, 0.4}, lying}, plate}), 0.4, 0.4, 1e-9);
    for (const Shape& brick :
         {Shape(Box{{1, 1.5, 0.3}}), Shape(cuboid({-1, -1.5, -0.3}, {1, 1.5, 0.3})), Shape(Cylinder{1, 0.3}),
          Shape(solid_of(cuboid_mesh({-1, -1.5, -0.3}, {1, 1.5, 0.3})))})
      expect_radii(contacts_of({{brick, {0, 0, 0.3}}, plate}), 0.3, 0.3, 1e-9);
  }
}

TEST(ReducedRadii, AreNoneAtEdgesAndCorners) {
  const Vec3 half(1, 2, 3);
  for (const Shape& block :
       {Shape(Box{half}), Shape(cuboid(-half, half)), Shape(solid_of(cuboid_mesh(-half, half)))})
    for (const Vec3& towards : {Vec3(1, 1, 0), Vec3(0, 1, 1), Vec3(1, 1, 1)}) {
      const Vec3 n = towards.normalized(), on_it = towards.cwiseProduct(half);
      for (const Contact& c : contacts_of({{Sphere{0.7}, on_it + (0.7 + gap) * n}, {block}})) {
        EXPECT_EQ(c.radii.least, 0) << shape_name(block);
        EXPECT_EQ(c.radii.largest, 0) << shape_name(block);
      }
    }
  const Vec3 rim(1, 0, 2), n = rim.normalized();
  const auto contacts = contacts_of({{Sphere{0.7}, rim + (0.7 + gap) * n}, {Cylinder{1, 2}}});
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_EQ(contacts[0].radii.largest, 0);
}

/// A mesh stands for the smooth surface that it is near to.
TEST(ReducedRadii, OfAMeshAreThoseOfItsSurface) {
  const Mesh ball = solid_of(icosphere(2, 3));
  for (int k = 0; k < 20; ++k) {
    const Vec3 n = Vec3(std::cos(k), std::sin(k), 0.3 * k - 3).normalized();
    const auto contacts = contacts_of({{Sphere{0.7}, 2.7 * n}, {ball}});
    ASSERT_FALSE(contacts.empty());
    const double right = 0.7 * 2 / 2.7;
    EXPECT_NEAR(contacts[0].radii.least, right, 0.1 * right) << k;
    EXPECT_NEAR(contacts[0].radii.largest, right, 0.1 * right) << k;
  }
  Scene s(0, 0);
  s.world.materials[0].rolling_friction = 0.1;
  s.add(s.shape(ball), Vec3(50, 50, 2));
  s.floor();
  expect_radii(contacts_in(s), 2, 2, 0.25);  // single facets scatter
}

}  // namespace
}  // namespace silt::rigid::testing

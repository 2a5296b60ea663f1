// The set of bodies, its table of rows, sums in fixed point, and walls.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include "rigid/bodies/body_set.hpp"
#include "rigid/shapes/shape.hpp"
#include "tests/rigid/scene.hpp"

namespace silt::rigid {
namespace {

TEST(FixedPoint, SumsDoNotDependOnTheirOrder) {
  std::mt19937_64 g(3);
  std::vector<double> terms(20000);
  for (double& t : terms)
    t = std::ldexp(std::uniform_real_distribution<>(-1, 1)(g), static_cast<int>(g() % 30) - 15);
  double reference = 0;
  for (int round = 0; round < 5; ++round) {
    FixedSum sum = 0;
    long double plain = 0;
    for (double t : terms) sum += to_fixed(t), plain += t;
    if (round == 0) reference = from_fixed(sum);
    EXPECT_EQ(from_fixed(sum), reference);
    EXPECT_NEAR(from_fixed(sum), static_cast<double>(plain), 1e-10);
    std::shuffle(terms.begin(), terms.end(), g);
  }
}

TEST(FixedPoint, RoundTripAndRange) {
  for (double x : {0.0, 1.0, -0.1, 3e-5, 4e18, -4e18}) EXPECT_NEAR(from_fixed(to_fixed(x)), x, 0x1p-64);
  EXPECT_EQ(from_fixed(to_fixed(-0.1)), -from_fixed(to_fixed(0.1)));
  EXPECT_THROW(to_fixed(0x1p62), std::overflow_error);
  EXPECT_THROW(to_fixed(std::numeric_limits<double>::quiet_NaN()), std::overflow_error);
  EXPECT_THROW(to_fixed(-std::numeric_limits<double>::infinity()), std::overflow_error);
}

TEST(Extent, WrapsIntoTheHalfOpenBox) {
  Extent e;
  e.size = {10, 10, 10};
  e.periodic = {true, true, false};
  std::array<std::int32_t, 3> image{};
  Vec3 x(-0.5, 20.25, -3);
  e.wrap(x, image);
  EXPECT_EQ(x, Vec3(9.5, 0.25, -3));
  EXPECT_EQ(image, (std::array<std::int32_t, 3>{-1, 2, 0}));
  x = {-1e-18, 10, 10};
  image = {};
  e.wrap(x, image);
  EXPECT_EQ(x, Vec3(0, 0, 10));
  EXPECT_EQ(image, (std::array<std::int32_t, 3>{0, 1, 0}));
  x = {1e300, -1e12, 0};  // flown away: in the box, with some large count
  e.wrap(x, image);
  EXPECT_TRUE(x[0] >= 0 && x[0] < 10 && x[1] >= 0 && x[1] < 10);
  EXPECT_EQ(image[0], 1 << 30);
}

BodyRecord body(BodyId id) {
  BodyRecord r;
  r.id = id;
  r.mass = 1.0 + static_cast<double>(id);
  r.position[0] = 0.5 * static_cast<double>(id);
  r.velocity[1] = 2.0 * static_cast<double>(id);
  return r;
}

TEST(BodySet, InsertSortEraseFind) {
  BodySet b;
  for (BodyId id : {5, 1, 9, 3}) b.add(body(id));
  b.force[2].add(Vec3(1, 2, 3));  // of id 9
  b.insert(4, body(8));           // copies
  b.insert(5, body(2));
  b.copies = 2;
  b.insert(6, body(first_wall_id + 4));
  b.walls = 1;
  b.reindex();
  EXPECT_EQ(b.id, (std::vector<BodyId>{1, 3, 5, 9, 2, 8, first_wall_id + 4}));
  EXPECT_EQ(b.row_of(8), 5u);
  EXPECT_EQ(b.row_of(7), b.size());
  EXPECT_EQ(b.first_wall(), 6u);
  EXPECT_EQ(b.force[3].value(), Vec3(1, 2, 3));
  for (std::size_t row = 0; row < 6; ++row) {
    EXPECT_EQ(b.mass[row], 1.0 + b.id[row]);
    EXPECT_EQ(b.position[row][0], 0.5 * b.id[row]);
    EXPECT_EQ(b.record(row).velocity[1], 2.0 * b.id[row]);
  }
  b.erase(1);
  --b.owned;
  b.reindex();
  EXPECT_EQ(b.row_of(3), b.size());
  EXPECT_EQ(b.row_of(9), 2u);
  EXPECT_EQ(b.force[2].value(), Vec3(1, 2, 3));
}

TEST(BodySet, RecordsCarryEverything) {
  testing::Scene s(0, 0);
  const int shape = s.shape(Box{{1, 2, 3}});
  s.add_with_id(7, shape, {{1, 2, 3}, Quat(0.5, 0.5, -0.5, 0.5)}, {4, 5, 6}, {0.1, 0.2, 0.3}, 5);
  s.bodies.image[0] = {1, -2, 3};
  AttachedState& held = s.bodies.attached_state[0];
  for (std::size_t k = 0; k < AttachedState::size; ++k) held.bytes[k] = std::byte(7 * k + 1);
  BodySet other;
  other.add(s.bodies.record(0));
  other.reindex();
  EXPECT_EQ(other.position[0], s.bodies.position[0]);
  EXPECT_EQ(other.orientation[0].coeffs(), s.bodies.orientation[0].coeffs());
  EXPECT_EQ(other.angular_momentum[0], s.bodies.angular_momentum[0]);
  EXPECT_EQ(other.inertia_B[0], s.bodies.inertia_B[0]);
  EXPECT_EQ(other.image[0], s.bodies.image[0]);
  EXPECT_TRUE(std::ranges::equal(other.attached_state[0].bytes, held.bytes));
}

TEST(BodySet, AngularVelocityAndMomentumStayConsistent) {
  testing::Scene s(0, 0);
  s.add(s.shape(Box{{1, 2, 3}}), {1, 2, 3});
  s.bodies.set_velocity(0, {1, 0, 0}, {1, 2, 3});
  s.bodies.set_pose(0, {{0, 0, 0}, Quat(0.1, 0.7, 0.2, -0.4).normalized()});
  EXPECT_LT((s.bodies.inverse_inertia_W(0) * s.bodies.angular_momentum[0] - Vec3(1, 2, 3)).norm(), 1e-13);
  EXPECT_EQ(s.bodies.angular_velocity[0], Vec3(1, 2, 3));
  s.bodies.motion[0] = Motion::fixed;
  EXPECT_EQ(s.bodies.inverse_inertia_W(0), Mat3::Zero());
  EXPECT_EQ(s.bodies.inverse_mass(0), 0);
}

TEST(Walls, RowsAndRefusals) {
  testing::Scene s(0, 0);
  s.extent.periodic = {true, false, false};
  std::array<WallSpec, 6> walls;
  for (WallSpec& w : walls) w.solid = true;
  walls[5].velocity = {0.5, 0, 0};
  add_walls(s.bodies, s.world, s.extent, walls);
  EXPECT_EQ(s.bodies.walls, 4u);
  EXPECT_EQ(s.bodies.id.front(), first_wall_id + 2);
  EXPECT_EQ(s.bodies.motion[3], Motion::prescribed);
  EXPECT_EQ(s.bodies.motion[0], Motion::fixed);
  EXPECT_EQ(s.bodies.position[3], Vec3(0, 0, 100));
  walls[5].velocity = {0, 0, 1};
  EXPECT_THROW(add_walls(s.bodies, s.world, s.extent, walls), std::invalid_argument);
}

constexpr std::size_t none = ~std::size_t{0};

std::size_t searched(const std::vector<BodyId>& ids, BodyId id) {
  const auto at = std::find(ids.begin(), ids.end(), id);
  return at == ids.end() ? none : std::size_t(at - ids.begin());
}

TEST(RowTable, FindsWhatASearchFinds) {
  std::mt19937_64 g(3);
  RowTable table;
  EXPECT_EQ(table.find(0, none), none) << "before anything was assigned";
  for (const int count : {0, 1, 2, 3, 64, 65, 1000}) {
    std::vector<BodyId> ids(count);
    for (BodyId& id : ids) id = g() % 2 ? g() % (2 * count) : g() % 100;  // some twice
    for (std::size_t k = 0; k < ids.size(); k += 3) ids[k] = ~ids[k];     // huge, as those of walls
    table.assign(ids);
    for (const BodyId id : ids) EXPECT_EQ(table.find(id, none), searched(ids, id));
    for (BodyId id = 0; id < BodyId(3 * count + 3); ++id) EXPECT_EQ(table.find(id, none), searched(ids, id));
  }
}

}  // namespace
}  // namespace silt::rigid

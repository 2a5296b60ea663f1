// Every broad phase against all pairs.
#include <ctime>

#include "tests/errors.hpp"
#include "tests/rigid/collision/cloud.hpp"

namespace silt::rigid::testing {
namespace {

class BroadPhases : public EachBroadPhase {};

TEST_P(BroadPhases, AgainstAllPairs) {
  for (int mask = 0; mask < 8; ++mask)
    expect_equal_to_brute(
        Cloud(300, {{10, 8, 6}, {bool(mask & 1), bool(mask & 2), bool(mask & 4)}}, 0.5, 0.5, 0, mask), 100);
}

TEST_P(BroadPhases, DomainsOfOneToThreeCells) {
  for (double size : {1.15, 1.7, 2.3, 3.4, 4.5})  // cells of about 1.1
    for (int mask = 1; mask < 8; ++mask)
      expect_equal_to_brute(Cloud(40, {{size, 2 * size, 6}, {bool(mask & 1), bool(mask & 2), bool(mask & 4)}},
                                  0.42, 0.42, 0, 100 + mask),
                            1);
}

TEST_P(BroadPhases, APairMeetsThroughSeveralImages) {
  Cloud cloud(2, {{1, 50, 50}, {true, false, false}}, 0.4, 0, 0, 1);
  cloud.bodies.position = {Vec3(0.2, 25, 25), Vec3(0.7, 25, 25)};
  cloud.bodies.motion = {Motion::free, Motion::free};
  const std::vector<Key> keys = cloud.found_by(*broad_phase);
  ASSERT_EQ(keys.size(), 2u);
  EXPECT_EQ(std::get<2>(keys[0]), (Image{-1, 0, 0}));
  EXPECT_EQ(std::get<2>(keys[1]), (Image{0, 0, 0}));
}

TEST_P(BroadPhases, MixedSizes) {
  expect_equal_to_brute(Cloud(600, {{20, 20, 20}, {true, true, true}}, 0.3, 4, 5, 9), 100);
  expect_equal_to_brute(Cloud(400, {{20, 20, 20}, {true, false, true}}, 0.05, 6, 3, 10), 100);
}

TEST_P(BroadPhases, WallsAreApart) {
  Cloud cloud(50, {{10, 10, 2}, {true, true, false}}, 0.5, 0.5, 0, 2);
  add_wall_rows(cloud.bodies, 1);
  std::vector<CandidatePair> pairs;
  const WallSurface floor{Vec3::Zero(), Vec3::UnitZ()};
  (*broad_phase)(cloud.bodies, cloud.extent, cloud.reach, {&floor, 1}, pairs);
  std::size_t walls = 0, expected = 0;
  for (const CandidatePair& p : pairs) walls += p.row_b == 50;
  for (std::size_t row = 0; row < 50; ++row)
    expected += cloud.bodies.is_dynamic(row) &&
                cloud.bodies.position[row][2] <= cloud.reach[row].radius + cloud.reach[row].margin;
  EXPECT_EQ(walls, expected);
  EXPECT_GT(walls, 0u);
}

TEST_P(BroadPhases,
       CostGrowsLinearly) {  // of all pairs the cost would grow 64-fold; processor time, the best of nine
  const auto seconds = [name = GetParam()](int count, double edge, double large, int large_ones) {
    Cloud cloud(count, {Vec3::Constant(edge), {true, true, true}}, 0.5, large, large_ones, 5);
    const auto broad_phase = adapters::make_broad_phase(name);
    std::vector<CandidatePair> pairs;
    (*broad_phase)(cloud.bodies, cloud.extent, cloud.reach, {}, pairs);
    double best = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 9; ++i) {
      for (std::size_t row = 0; row < cloud.bodies.size(); ++row) {  // too far for what is kept
        cloud.bodies.position[row] += Vec3::Constant((row % 2 ? 0.4 : 0.1) * edge);
        cloud.extent.wrap(cloud.bodies.position[row], cloud.bodies.image[row]);
      }
      const std::clock_t start = std::clock();
      (*broad_phase)(cloud.bodies, cloud.extent, cloud.reach, {}, pairs);
      best = std::min(best, double(std::clock() - start) / CLOCKS_PER_SEC);
    }
    return best;
  };
  const double small = seconds(4000, 22, 0.5, 0), big = seconds(32000, 44, 0.5, 0);
  EXPECT_LT(big / small, 8 * 4.0);
  EXPECT_LT(seconds(32000, 44, 10, 4) / big, 4.0) << "a few large bodies make the small ones slow";
}

TEST_P(BroadPhases, SizesAThousandTimesApart) {
  expect_equal_to_brute(Cloud(400, {{20, 20, 20}, {true, true, false}}, 0.01, 10, 2, 11), 100);
}

TEST_P(BroadPhases, OneBodyHasNoPartner) {
  for (const double radius : {0.1, 0.9})  // the larger one would meet its own image
    EXPECT_TRUE(Cloud(1, {{1, 1, 1}, {true, true, true}}, radius, 0, 0, 3).found_by(*broad_phase).empty());
}

TEST_P(BroadPhases, NoBodies) {
  EXPECT_TRUE(Cloud(0, {{1, 1, 1}, {true, false, true}}, 0.1, 0, 0, 3).found_by(*broad_phase).empty());
}

TEST_P(BroadPhases, AllAtOnePlace) {
  Cloud cloud(120, {{5, 5, 5}, {true, true, true}}, 0.4, 0, 0, 4);
  for (Vec3& x : cloud.bodies.position) x = Vec3(0.1, 4.9, 2);
  expect_equal_to_brute(cloud, 5000);
  for (Reach& r : cloud.reach) r = {0, 0};  // points that coincide
  expect_equal_to_brute(cloud, 5000);
}

TEST_P(BroadPhases, TouchingToTheLastBits) {
  Cloud cloud(2, {{10, 10, 10}, {true, false, false}}, 1, 0, 0, 4);
  cloud.bodies.motion = {Motion::free, Motion::free};
  cloud.reach = {{0.75, 0.25}, {0.5, 0.5}};
  for (const double from : {2.0, 9.0}) {  // the second time through the periodic side
    const double to = from == 2 ? 4 : 1;
    cloud.bodies.position = {Vec3(from, 5, 5), Vec3(to, 5, 5)};
    EXPECT_EQ(cloud.found_by(*broad_phase).size(), 1u);
    cloud.bodies.position[1][0] = to + 4e-15;  // two units in the last place of 11
    EXPECT_EQ(cloud.found_by(*broad_phase).size(), 0u);
  }
}

INSTANTIATE_TEST_SUITE_P(BroadPhase, BroadPhases, every_broad_phase(),
                         [](const auto& info) { return info.param; });

TEST(BroadPhaseFactory, KnowsTheNamesAndTakesTheBackendsOwn) {
  const auto names = adapters::broad_phase_names();
  EXPECT_EQ(names, (std::vector<std::string_view>{"auto", "grid", "bullet", "fcl"}));
  for (const auto name : names)
    EXPECT_EQ(adapters::make_broad_phase(name, "fcl")->name(), name == "auto" ? "fcl" : name);
  for (const auto& [backend, own] : {std::pair("auto", "grid"), std::pair("analytic", "grid"),
                                     std::pair("bullet", "bullet"), std::pair("fcl", "fcl")})
    EXPECT_EQ(adapters::make_broad_phase("auto", backend)->name(), own);
  EXPECT_EQ(tests::error_of<std::invalid_argument>([] { adapters::make_broad_phase("gird"); }),
            "unknown broad phase \"gird\"; known: auto, grid, bullet, fcl");
}

}  // namespace
}  // namespace silt::rigid::testing

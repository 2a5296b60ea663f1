// Every broad phase against all pairs.

#include <gtest/gtest.h>

#include <ctime>
#include <map>
#include <random>
#include <set>

#include "adapters/automatic/broad_phase_factory.hpp"

namespace silt::rigid {
namespace {

using Key = std::tuple<BodyId, BodyId, Image>;

struct Cloud {
  BodySet bodies;
  std::vector<Reach> reach;
  Extent extent;

  Cloud(int count, Vec3 size, std::array<bool, 3> periodic, double small, double large, int large_ones,
        unsigned seed) {
    extent.size = size;
    extent.periodic = periodic;
    std::mt19937 g(seed);
    std::uniform_real_distribution<> u(0, 1);
    std::vector<BodyId> ids(count);
    for (int i = 0; i < count; ++i) ids[i] = 3 * i + 1;
    std::shuffle(ids.begin(), ids.end(), g);
    std::map<BodyId, Reach> by_id;
    for (int i = 0; i < count; ++i) {
      BodyRecord r;
      r.id = ids[i];
      for (int d = 0; d < 3; ++d) r.position[d] = size[d] * u(g) + (periodic[d] ? 0.0 : 0.05 * (u(g) - 0.5));
      r.motion = u(g) < 0.2 ? Motion::fixed : Motion::free;
      const double radius = i < large_ones ? large * (0.5 + u(g)) : small * (0.7 + 0.6 * u(g));
      by_id[r.id] = {radius, 0.1 * radius * u(g)};
      bodies.add(r);
    }
    bodies.reindex();
    for (BodyId id : bodies.id) reach.push_back(by_id[id]);
  }

  std::set<Key> brute() const {
    std::set<Key> found;
    const auto images = [&](int d) { return extent.periodic[d] ? 1 : 0; };
    for (std::size_t a = 0; a < bodies.first_wall(); ++a)
      for (std::size_t b = 0; b < bodies.first_wall(); ++b) {
        if (bodies.id[a] >= bodies.id[b] || (!bodies.is_free(a) && !bodies.is_free(b))) continue;
        for (int i = -images(0); i <= images(0); ++i)
          for (int j = -images(1); j <= images(1); ++j)
            for (int k = -images(2); k <= images(2); ++k) {
              const Image image{static_cast<std::int8_t>(i), static_cast<std::int8_t>(j),
                                static_cast<std::int8_t>(k)};
              const Vec3 apart = bodies.position[b] + extent.shift(image) - bodies.position[a];
              const double range = reach[a].radius + reach[a].margin + reach[b].radius + reach[b].margin;
              if (apart.norm() <= range) found.emplace(bodies.id[a], bodies.id[b], image);
            }
      }
    return found;
  }

  std::vector<Key> found_by(BroadPhase& broad_phase) const {
    std::vector<CandidatePair> pairs;
    broad_phase(bodies, extent, reach, {}, pairs);
    std::vector<Key> keys;
    for (const CandidatePair& p : pairs) keys.emplace_back(bodies.id[p.row_a], bodies.id[p.row_b], p.image);
    return keys;
  }
};

/// Rows for walls.
void add_wall_rows(BodySet& bodies, std::size_t count) {
  for (std::size_t n = 0; n < count; ++n) {
    BodyRecord wall;
    wall.id = first_wall_id + 4 + n;
    wall.motion = Motion::fixed;
    bodies.insert(bodies.size(), wall);
  }
  bodies.walls = count;
  bodies.reindex();
}

class BroadPhases : public ::testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<BroadPhase> broad_phase = adapters::make_broad_phase(GetParam());

  void expect_equal_to_brute(const Cloud& cloud, std::size_t least) {
    const std::vector<Key> keys = cloud.found_by(*broad_phase);
    EXPECT_TRUE(std::is_sorted(keys.begin(), keys.end()));
    const std::set<Key> unique(keys.begin(), keys.end());
    EXPECT_EQ(unique.size(), keys.size()) << "duplicates";
    EXPECT_EQ(unique, cloud.brute());
    EXPECT_GE(keys.size(), least);
  }
};

TEST_P(BroadPhases, AgainstAllPairs) {
  for (int mask = 0; mask < 8; ++mask)
    expect_equal_to_brute(
        Cloud(300, {10, 8, 6}, {bool(mask & 1), bool(mask & 2), bool(mask & 4)}, 0.5, 0.5, 0, mask), 100);
}

TEST_P(BroadPhases, DomainsOfOneToThreeCells) {
  for (double size : {1.15, 1.7, 2.3, 3.4, 4.5})  // cells of about 1.1
    for (int mask = 1; mask < 8; ++mask)
      expect_equal_to_brute(Cloud(40, {size, 2 * size, 6}, {bool(mask & 1), bool(mask & 2), bool(mask & 4)},
                                  0.42, 0.42, 0, 100 + mask),
                            1);
}

TEST_P(BroadPhases, APairMeetsThroughSeveralImages) {
  Cloud cloud(2, {1, 50, 50}, {true, false, false}, 0.4, 0, 0, 1);
  cloud.bodies.position = {Vec3(0.2, 25, 25), Vec3(0.7, 25, 25)};
  cloud.bodies.motion = {Motion::free, Motion::free};
  const std::vector<Key> keys = cloud.found_by(*broad_phase);
  ASSERT_EQ(keys.size(), 2u);
  EXPECT_EQ(std::get<2>(keys[0]), (Image{-1, 0, 0}));
  EXPECT_EQ(std::get<2>(keys[1]), (Image{0, 0, 0}));
}

TEST_P(BroadPhases, MixedSizes) {
  expect_equal_to_brute(Cloud(600, {20, 20, 20}, {true, true, true}, 0.3, 4, 5, 9), 100);
  expect_equal_to_brute(Cloud(400, {20, 20, 20}, {true, false, true}, 0.05, 6, 3, 10), 100);
}

TEST_P(BroadPhases, WallsAreApart) {
  Cloud cloud(50, {10, 10, 2}, {true, true, false}, 0.5, 0.5, 0, 2);
  add_wall_rows(cloud.bodies, 1);
  std::vector<CandidatePair> pairs;
  const WallSurface floor{Vec3::Zero(), Vec3::UnitZ()};
  (*broad_phase)(cloud.bodies, cloud.extent, cloud.reach, {&floor, 1}, pairs);
  std::size_t walls = 0, expected = 0;
  for (const CandidatePair& p : pairs) walls += p.row_b == 50;
  for (std::size_t row = 0; row < 50; ++row)
    expected += cloud.bodies.is_free(row) &&
                cloud.bodies.position[row][2] <= cloud.reach[row].radius + cloud.reach[row].margin;
  EXPECT_EQ(walls, expected);
  EXPECT_GT(walls, 0u);
}

TEST_P(BroadPhases,
       CostGrowsLinearly) {  // of all pairs the cost would grow 64-fold; processor time, the best of nine
  const auto seconds = [name = GetParam()](int count, double edge, double large, int large_ones) {
    Cloud cloud(count, Vec3::Constant(edge), {true, true, true}, 0.5, large, large_ones, 5);
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
  expect_equal_to_brute(Cloud(400, {20, 20, 20}, {true, true, false}, 0.01, 10, 2, 11), 100);
}

TEST_P(BroadPhases, OneBodyHasNoPartner) {
  for (const double radius : {0.1, 0.9})  // the larger one would meet its own image
    EXPECT_TRUE(Cloud(1, {1, 1, 1}, {true, true, true}, radius, 0, 0, 3).found_by(*broad_phase).empty());
}

TEST_P(BroadPhases, NoBodies) {
  EXPECT_TRUE(Cloud(0, {1, 1, 1}, {true, false, true}, 0.1, 0, 0, 3).found_by(*broad_phase).empty());
}

TEST_P(BroadPhases, AllAtOnePlace) {
  Cloud cloud(120, {5, 5, 5}, {true, true, true}, 0.4, 0, 0, 4);
  for (Vec3& x : cloud.bodies.position) x = Vec3(0.1, 4.9, 2);
  expect_equal_to_brute(cloud, 5000);
  for (Reach& r : cloud.reach) r = {0, 0};  // points that coincide
  expect_equal_to_brute(cloud, 5000);
}

TEST_P(BroadPhases, TouchingToTheLastBits) {
  Cloud cloud(2, {10, 10, 10}, {true, false, false}, 1, 0, 0, 4);
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

/// Bodies that move through periodic sides, now and then far, grow, shrink, come and go.
TEST_P(BroadPhases, FollowsBodiesOverManySteps) {
  std::mt19937 g(7);
  std::normal_distribution<> normal;
  for (const std::array<bool, 3> periodic : {std::array{true, true, true}, std::array{false, true, false}}) {
    Cloud all(250, {9, 8, 7}, periodic, 0.4, 2, 2, 21);
    for (int step = 0; step < 100; ++step) {
      for (std::size_t row = 0; row < all.bodies.size(); ++row) {
        Vec3& x = all.bodies.position[row];
        const double stride = g() % 50 ? 0.02 : 3;
        x += stride * Vec3(normal(g), normal(g), normal(g));
        std::array<std::int32_t, 3> image{};
        all.extent.wrap(x, image);
        all.reach[row].margin = 0.1 * all.reach[row].radius * (g() % 8);
      }
      Cloud here = all;  // without some of them, others from step to step
      for (std::size_t row = here.bodies.owned; row-- > 0;)
        if ((here.bodies.id[row] + step / 5) % 7 == 0) {
          here.bodies.erase(row);
          --here.bodies.owned;
          here.reach.erase(here.reach.begin() + row);
        }
      here.bodies.reindex();
      expect_equal_to_brute(here, 50);
      if (HasFailure()) FAIL() << "in step " << step;
    }
  }
}

/// Slowly, so that pairs found once serve for many steps; through periodic sides, in wide domains and in one
/// hardly wider than a body. Now and then one is thrown, grows or is fixed.
TEST_P(BroadPhases, FollowsBodiesThatCreep) {
  std::mt19937 g(8);
  std::normal_distribution<> normal;
  for (const Vec3& size : {Vec3(5, 4, 4), Vec3(0.8, 4, 6)}) {
    Cloud cloud(80, size, {true, true, false}, 0.4, 0.5, 2, 22);
    std::vector<Vec3> velocity(80);
    for (Vec3& v : velocity) v = 1e-3 * Vec3(normal(g), normal(g), normal(g));
    for (int step = 0; step < 600; ++step) {
      for (std::size_t row = 0; row < cloud.bodies.size(); ++row) {
        cloud.bodies.position[row] += velocity[row];
        if (g() % 4000 == 0) cloud.bodies.position[row] += Vec3(2, 0, 0);
        if (g() % 4000 == 0) cloud.reach[row].radius *= 1.1;
        if (g() % 4000 == 0) cloud.bodies.motion[row] = Motion::free;
        cloud.extent.wrap(cloud.bodies.position[row], cloud.bodies.image[row]);
      }
      expect_equal_to_brute(cloud, 50);
      if (HasFailure()) FAIL() << "in step " << step;
    }
  }
}

/// Bodies that fall together, past some that are fixed and on to two floors, one above the other.
struct FallingCloud {
  Cloud cloud;
  const std::array<WallSurface, 2> walls{{{{0, 0, 12.9}, {0, 0, 1}}, {{0, 0, 12}, {0, 0, 1}}}};
  const Vec3 velocity;
  std::vector<Vec3> own_velocity;
  bool turns = false;  // own velocities do, each body's at its own time
  int now = 0;

  FallingCloud(const Vec3& common, double own_speed, bool all_fall, double width = 6, double small = 0.3,
               double large = 1.5)
      : cloud(200, {width, width, 40}, {true, true, false}, small, large, 3, 23), velocity(common) {
    std::mt19937 g(9);
    std::normal_distribution<> normal;
    for (std::size_t row = 0; row < cloud.bodies.size(); ++row) {
      own_velocity.push_back(own_speed * Vec3(normal(g), normal(g), normal(g)));
      cloud.bodies.motion[row] = all_fall || row % 20 ? Motion::free : Motion::fixed;
    }
    add_wall_rows(cloud.bodies, walls.size());
  }
  void step() {
    ++now;
    for (std::size_t row = 0; row < cloud.bodies.first_wall(); ++row) {
      if (!cloud.bodies.is_free(row)) continue;
      const bool back = turns && (now + 5 * row) % 24 < 12;
      cloud.bodies.position[row] += back ? Vec3(velocity - own_velocity[row]) : velocity + own_velocity[row];
      cloud.extent.wrap(cloud.bodies.position[row], cloud.bodies.image[row]);
    }
  }
  using Pairs = std::pair<std::set<Key>, std::set<std::pair<BodyId, BodyId>>>;  // of bodies; with walls

  Pairs found_by(BroadPhase& broad_phase, const Cloud& here) const {
    std::vector<CandidatePair> pairs;
    broad_phase(here.bodies, here.extent, here.reach, walls, pairs);
    Pairs found;
    std::vector<Key> keys;
    for (const CandidatePair& p : pairs) {
      const BodyId a = here.bodies.id[p.row_a];
      keys.emplace_back(a, here.bodies.id[p.row_b], p.image);
      if (p.row_b < here.bodies.first_wall())
        found.first.insert(keys.back());
      else
        found.second.emplace(a, here.bodies.id[p.row_b]);
    }
    EXPECT_TRUE(std::is_sorted(keys.begin(), keys.end()));
    EXPECT_EQ(found.first.size() + found.second.size(), keys.size()) << "each once";
    return found;
  }
  Pairs brute(const Cloud& here) const {
    std::set<std::pair<BodyId, BodyId>> near_walls;
    for (std::size_t row = 0; row < here.bodies.first_wall(); ++row)
      for (std::size_t w = 0; w < walls.size(); ++w)
        if (here.bodies.is_free(row) && walls[w].distance(here.bodies.position[row]) <= here.reach[row].sum())
          near_walls.emplace(here.bodies.id[row], here.bodies.id[here.bodies.first_wall() + w]);
    return {here.brute(), near_walls};
  }
  Pairs found_by(BroadPhase& broad_phase) const { return found_by(broad_phase, cloud); }
  Pairs brute() const { return brute(cloud); }

  /// For so many of 1000 steps.
  static bool is_away(BodyId id, int step, int steps) {
    return ((id * 0x9E3779B97F4A7C15 >> 40) + 8 * step) % 1000 < unsigned(steps);
  }

  /// What a rank of many would have of it: every other body or so, some of them as copies; in each step a few
  /// come, a few go, and a few change hands.
  Cloud part(int step) const {
    Cloud here = cloud;
    for (std::size_t row = here.bodies.first_wall(); row-- > 0;)
      if (is_away(here.bodies.id[row], step, 400)) {
        here.bodies.erase(row);
        --here.bodies.owned;
        here.reach.erase(here.reach.begin() + row);
      }
    BodySet& bodies = here.bodies;
    for (std::size_t row = bodies.owned; row-- > 0;)
      if (is_away(~bodies.id[row], step, 300)) {
        const BodyRecord record = bodies.record(row);
        const Reach reach = here.reach[row];
        const std::size_t copies_begin = bodies.owned - 1;
        bodies.erase(row);
        here.reach.erase(here.reach.begin() + row);
        bodies.insert(copies_begin, record);
        here.reach.insert(here.reach.begin() + copies_begin, reach);
        --bodies.owned, ++bodies.copies;
      }
    bodies.reindex();
    return here;
  }
};

/// Where all fall alike only the floor asks for new pairs.
TEST_P(BroadPhases, FollowsBodiesThatFallTogether) {
  for (const bool all_alike : {false, true}) {
    FallingCloud falling({0.01, 0, -0.06}, all_alike ? 0 : 2e-4, all_alike);
    const std::size_t near_floor = falling.brute().second.size();
    for (int step = 0; step < 150; ++step) {
      ASSERT_EQ(falling.found_by(*broad_phase), falling.brute()) << "in step " << step;
      falling.step();
    }
    EXPECT_GT(falling.brute().second.size(), near_floor + 20) << "have come to the floor";
  }
}

/// Through periodic sides, too.
TEST_P(BroadPhases, FollowsBodiesThatComeAndGo) {
  for (const Vec3& common : {Vec3(0.05, 0, -0.06), Vec3(0.05, -0.02, 0)})
    for (const double own : {1e-2, 1e-3, 1e-5})
      for (const double width : {6.0, 10.0}) {  // a newcomer may meet two images of another, or one
        FallingCloud falling(common, own, false, width, 0.8, 0.9);
        falling.turns = true;
        for (int step = 0; step < 150; ++step) {
          const Cloud here = falling.part(step);
          ASSERT_EQ(falling.found_by(*broad_phase, here), falling.brute(here)) << "in step " << step;
          falling.step();
        }
      }
}

/// It counts how often it has to look.
struct CountSearches : BroadPhase {
  int searches = 0;
  std::string_view name() const override { return "counting"; }
  void find_pairs(const Surroundings& around, std::vector<CandidatePair>& found) override {
    ++searches;
    for (std::size_t a = 0; a < around.size(); ++a)
      for (std::size_t b = a + 1; b < around.size(); ++b)
        if (const CandidatePair p = around.in_order(a, b, {}); around.meet(p)) found.push_back(p);
  }
};

TEST(KeptPairs, BodiesThatComeAndGoCostFewSearches) {
  constexpr int steps = 60;
  FallingCloud falling({0.01, 0, -0.06}, 2e-4, true, 10, 0.5, 0.9);
  CountSearches counting;
  for (int step = 0; step < steps; ++step) {
    falling.found_by(counting, falling.part(step));
    falling.step();
  }
  EXPECT_LE(counting.searches, steps / 3);
}

/// Bodies in a row along x, whose radii and positions are told.
struct Row {
  Cloud cloud{0, {60, 9, 9}, {true, false, false}, 0, 0, 0, 1};
  std::unique_ptr<BroadPhase> grid = adapters::make_broad_phase("grid");

  Row() {  // and small ones that make it worth while to keep pairs
    for (int n = 0; n < 20; ++n) add(100 + n, 0.1, {0.5 + n, 0.2, 0.2});
  }
  void add(BodyId id, double radius, const Vec3& x) {
    BodyRecord r;
    r.id = id;
    Eigen::Map<Vec3>{r.position} = x;
    const std::size_t row =
        std::lower_bound(cloud.bodies.id.begin(), cloud.bodies.id.end(), id) - cloud.bodies.id.begin();
    cloud.bodies.insert(row, r);
    ++cloud.bodies.owned;
    cloud.bodies.reindex();
    cloud.reach.insert(cloud.reach.begin() + row, {radius, 0});
  }
  void move(BodyId id, const Vec3& by) { cloud.bodies.position[cloud.bodies.row_of(id)] += by; }
  void look() {
    const std::vector<Key> found = cloud.found_by(*grid);
    EXPECT_EQ(std::set<Key>(found.begin(), found.end()), cloud.brute());
  }
};

TEST(KeptPairs, WhatANewcomerIsToMeetMayComeBackFromWhereItHasGone) {
  Row row;
  row.add(1, 2, {10, 4, 4});
  row.look();
  row.move(1, {1e-6, 0, 0});
  row.look();  // with a slack of 0.1 for the large one
  row.move(1, {0.09, 0, 0});
  row.add(2, 0.5, {10.09 - 2.5 - 0.14, 4, 4});
  row.look();
  row.move(1, {-0.18, 0, 0});
  row.look();
  EXPECT_EQ(row.cloud.brute().size(), 1u);
}

TEST(KeptPairs, ANewcomerMeetsTwoImagesOfAnother) {
  Row row;
  row.cloud.extent.size[0] = 21;
  row.add(1, 5.4, {1, 6, 6});
  row.look();
  row.move(1, {1e-6, 0, 0});
  row.look();
  row.add(2, 5.4, {11.4, 6, 6});
  row.look();
  EXPECT_EQ(row.cloud.brute().size(), 2u);
}

TEST(KeptPairs, AFallThatAllShareCostsNoMoreSearchesThanRest) {
  constexpr int steps = 60;
  const auto searches = [&](const Vec3& common) {
    FallingCloud falling(common, 2e-4, false);
    CountSearches counting;
    for (int step = 0; step < steps; ++step) falling.found_by(counting), falling.step();
    return counting.searches;
  };
  EXPECT_LE(searches({0, 0, 0}), 4);
  EXPECT_LE(searches({0, 0, -0.06}), steps / 3);  // a fifth of a radius a step
}

/// What was there before must not show.
TEST_P(BroadPhases, KeepsNothingThatShows) {
  const Cloud before(300, {10, 8, 6}, {true, false, true}, 0.7, 2, 3, 30);
  const Cloud after(200, {10, 8, 6}, {true, false, true}, 0.4, 3, 2, 31);
  before.found_by(*broad_phase);
  Cloud(0, {1, 1, 1}, {}, 0.1, 0, 0, 3).found_by(*broad_phase);
  EXPECT_EQ(after.found_by(*broad_phase), after.found_by(*adapters::make_broad_phase("grid")));
}

INSTANTIATE_TEST_SUITE_P(BroadPhase, BroadPhases, ::testing::Values("grid", "bullet", "fcl"),
                         [](const auto& info) { return info.param; });

TEST(BroadPhaseFactory, KnowsTheNamesAndTakesTheBackendsOwn) {
  const auto names = adapters::broad_phase_names();
  EXPECT_EQ(names, (std::vector<std::string_view>{"auto", "grid", "bullet", "fcl"}));
  for (const auto name : names)
    EXPECT_EQ(adapters::make_broad_phase(name, "fcl")->name(), name == "auto" ? "fcl" : name);
  for (const auto& [backend, own] : {std::pair("auto", "grid"), std::pair("analytic", "grid"),
                                     std::pair("bullet", "bullet"), std::pair("fcl", "fcl")})
    EXPECT_EQ(adapters::make_broad_phase("auto", backend)->name(), own);
  try {
    adapters::make_broad_phase("gird");
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_STREQ(e.what(), "unknown broad phase \"gird\"; known: auto, grid, bullet, fcl");
  }
}

}  // namespace
}  // namespace silt::rigid

// Every broad phase, asked again and again while bodies move, come and go, against all pairs; and how often
// it has to look anew.
#include "tests/rigid/collision/cloud.hpp"

namespace silt::rigid::testing {
namespace {

class KeptPairsOf : public EachBroadPhase {};

/// Bodies that move through periodic sides, now and then far, grow, shrink, come and go.
TEST_P(KeptPairsOf, FollowsBodiesOverManySteps) {
  std::mt19937 g(7);
  std::normal_distribution<> normal;
  for (const std::array<bool, 3> periodic : {std::array{true, true, true}, std::array{false, true, false}}) {
    Cloud all(250, {{9, 8, 7}, periodic}, 0.4, 2, 2, 21);
    for (int step = 0; step < 60; ++step) {
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
TEST_P(KeptPairsOf, FollowsBodiesThatCreep) {
  std::mt19937 g(8);
  std::normal_distribution<> normal;
  for (const Vec3& size : {Vec3(5, 4, 4), Vec3(0.8, 4, 6)}) {
    Cloud cloud(80, {size, {true, true, false}}, 0.4, 0.5, 2, 22);
    std::vector<Vec3> velocity(80);
    for (Vec3& v : velocity) v = 1e-3 * Vec3(normal(g), normal(g), normal(g));
    for (int step = 0; step < 300; ++step) {
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
      : cloud(200, {{width, width, 40}, {true, true, false}}, small, large, 3, 23), velocity(common) {
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
      if (!cloud.bodies.is_dynamic(row)) continue;
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
        if (here.bodies.is_dynamic(row) &&
            walls[w].distance(here.bodies.position[row]) <= here.reach[row].sum())
          near_walls.emplace(here.bodies.id[row], here.bodies.id[here.bodies.first_wall() + w]);
    return {here.brute(), near_walls};
  }
  Pairs found_by(BroadPhase& broad_phase) const { return found_by(broad_phase, cloud); }
  Pairs brute() const { return brute(cloud); }

  /// For so many of 1000 steps.
  static bool is_away(BodyId id, int step, int steps) {
    return ((id * 0x9E3779B97F4A7C15 >> 40) + 8 * step) % 1000 < unsigned(steps);
  }

  /// Returns what a rank of many would have: every other body or so, some of them as copies; in each step a
  /// few come, a few go, and a few change hands.
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

/// If all fall alike, only the floor asks for new pairs.
TEST_P(KeptPairsOf, FollowsBodiesThatFallTogether) {
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
TEST_P(KeptPairsOf, FollowsBodiesThatComeAndGo) {
  for (const Vec3& common : {Vec3(0.05, 0, -0.06), Vec3(0.05, -0.02, 0)})
    for (const double own : {1e-2, 1e-5})
      for (const double width : {6.0, 10.0}) {  // a newcomer may meet two images of another, or one
        FallingCloud falling(common, own, false, width, 0.8, 0.9);
        falling.turns = true;
        for (int step = 0; step < 60; ++step) {
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
  Cloud cloud{0, {{60, 9, 9}, {true, false, false}}, 0, 0, 0, 1};
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

/// The pairs that were there before must not show.
TEST_P(KeptPairsOf, KeepsNothingThatShows) {
  const Cloud before(300, {{10, 8, 6}, {true, false, true}}, 0.7, 2, 3, 30);
  const Cloud after(200, {{10, 8, 6}, {true, false, true}}, 0.4, 3, 2, 31);
  before.found_by(*broad_phase);
  Cloud(0, {{1, 1, 1}, {}}, 0.1, 0, 0, 3).found_by(*broad_phase);
  EXPECT_EQ(after.found_by(*broad_phase), after.found_by(*adapters::make_broad_phase("grid")));
}

INSTANTIATE_TEST_SUITE_P(KeptPairs, KeptPairsOf, every_broad_phase(),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace silt::rigid::testing

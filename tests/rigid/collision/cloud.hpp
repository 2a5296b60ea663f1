#pragma once
// Clouds of bodies for tests of broad phases, and the way to find their pairs that cannot be wrong.
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "adapters/automatic/collision_factory.hpp"

namespace silt::rigid::testing {

using Key = std::tuple<BodyId, BodyId, Image>;

struct Cloud {
  BodySet bodies;
  std::vector<Reach> reach;
  Extent extent;

  Cloud(int count, const Extent& in, double small, double large, int large_ones, unsigned seed) : extent(in) {
    std::mt19937 g(seed);
    std::uniform_real_distribution<> u(0, 1);
    std::vector<BodyId> ids(count);
    for (int i = 0; i < count; ++i) ids[i] = 3 * i + 1;
    std::shuffle(ids.begin(), ids.end(), g);
    std::map<BodyId, Reach> by_id;
    for (int i = 0; i < count; ++i) {
      BodyRecord r;
      r.id = ids[i];
      for (int d = 0; d < 3; ++d)
        r.position[d] = in.size[d] * u(g) + (in.periodic[d] ? 0.0 : 0.05 * (u(g) - 0.5));
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
        if (bodies.id[a] >= bodies.id[b] || (!bodies.is_dynamic(a) && !bodies.is_dynamic(b))) continue;
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
inline void add_wall_rows(BodySet& bodies, std::size_t count) {
  for (std::size_t n = 0; n < count; ++n) {
    BodyRecord wall;
    wall.id = first_wall_id + 4 + n;
    wall.motion = Motion::fixed;
    bodies.insert(bodies.size(), wall);
  }
  bodies.walls = count;
  bodies.reindex();
}

/// Names of those that are tested.
inline auto every_broad_phase() {
  return ::testing::Values("grid", "bullet", "fcl");
}

/// A test for each of them.
class EachBroadPhase : public ::testing::TestWithParam<std::string> {
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

}  // namespace silt::rigid::testing

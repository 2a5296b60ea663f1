// Motions that are given as functions of time, and what ranks agree on by words between neighbours.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/prescribed_motion.hpp"
#include "rigid/math/types.hpp"

namespace silt::rigid {
namespace {

using Graph = std::vector<std::set<int>>;

PrescribedMotion table_motion() {
  PrescribedMotion m;
  m.table = {{1, {0, 0, 0}, {0, 0, 0}},
             {3, {1, 0.5, -1}, {0.3, -0.2, 1}},
             {4, {1.5, 0, -2}, {0.5, 0.4, 2.5}},
             {8, {0, 0, 0}, {0, 0, 3}}};
  return m;
}

std::vector<PrescribedMotion> motions() {
  PrescribedMotion turn, swing, table = table_motion();
  turn.angular_velocity = {0.1, -0.3, 0.7}, turn.velocity = {0.01, 0.02, 0};
  swing.amplitude = {0.5, 0, 2}, swing.frequency = 0.07;
  return {turn, swing, table};
}

TEST(PrescribedMotion, VelocityIsTheDerivativeOfThePose) {
  const Pose start{{1, 2, 3}, Quat(0.5, 0.1, -0.7, 0.3).normalized()};
  const Vec3 point(0.3, -1.2, 2);  // of the wall
  constexpr double h = 1e-5;
  for (const PrescribedMotion& m : motions())
    for (const double t : {0.5, 1.3, 2.9, 3.7, 5.1, 9.}) {
      const Pose now = m.pose(start, t), before = m.pose(start, t - h), after = m.pose(start, t + h);
      const PrescribedMotion::Velocity v = m.velocity_at(t);
      const Vec3 moved = (after.to_world(point) - before.to_world(point)) / (2 * h);
      EXPECT_LT((v.linear + v.angular.cross(now.to_world(point) - now.position) - moved).norm(), 1e-8) << t;
    }
}

TEST(PrescribedMotion, NoPointIsFasterThanItsBound) {
  constexpr double radius = 2.5;
  for (const PrescribedMotion& m : motions()) {
    double fastest = 0;
    for (double t = 0; t < 20; t += 0.01) {
      const PrescribedMotion::Velocity v = m.velocity_at(t);
      fastest = std::max(fastest, v.linear.norm() + radius * v.angular.norm());
    }
    EXPECT_LE(fastest, m.speed_bound(radius) * (1 + 1e-12));
    EXPECT_GT(fastest, 0.5 * m.speed_bound(radius)) << "the bound is of use";
  }
}

TEST(PrescribedMotion, ATableIsMetAndHeldBeforeAndAfterIt) {
  const PrescribedMotion m = table_motion();
  for (const MotionRow& row : m.table) {
    EXPECT_LT((m.pose({}, row.time).position - row.displacement).norm(), 1e-14);
    const Quat turned(Eigen::AngleAxisd(row.rotation.norm(), row.rotation.stableNormalized()));
    EXPECT_GT(std::abs(m.pose({}, row.time).orientation.dot(turned)), 1 - 1e-14);
  }
  EXPECT_EQ(m.pose({}, 100).position, m.pose({}, 8).position);
  EXPECT_EQ(m.velocity_at(100).linear.norm() + m.velocity_at(0).linear.norm(), 0);
  EXPECT_LT(m.velocity_at(1 + 1e-9).linear.norm(), 1e-8) << "it starts from rest";
}

/// A body has a pose and constant velocities in a step; with them it comes to where the motion leads.
TEST(PrescribedMotion, StepByStepItLeadsToThePose) {
  for (const PrescribedMotion& m : motions()) {
    const Pose start{{1, 2, 3}, Quat(0.5, 0.1, -0.7, 0.3).normalized()};
    Pose pose = start;
    for (int step = 0; step < 10; ++step) {
      const PrescribedMotion::Velocity v = m.over_step(step);
      pose = {pose.position + v.linear, rotation_by(v.angular) * pose.orientation};
    }
    const Vec3 gone = m.pose(start, 10).position - m.pose(start, 0).position;
    EXPECT_LT((pose.position - start.position - gone).norm(), 1e-12);
    const Quat turned = m.pose(start, 10).orientation * m.pose(start, 0).orientation.conjugate();
    EXPECT_GT(std::abs((turned * start.orientation).dot(pose.orientation)), 1 - 1e-12);
  }
}

TEST(PrescribedMotion, OnlyWhatMovesMoves) {
  EXPECT_FALSE(PrescribedMotion{}.moves());
  for (const PrescribedMotion& m : motions()) EXPECT_TRUE(m.moves());
  PrescribedMotion still;
  still.amplitude = {1, 0, 0};
  EXPECT_FALSE(still.moves()) << "without a frequency";
}

Graph chain(int ranks) {
  Graph g(ranks);
  for (int r = 1; r < ranks; ++r) g[r].insert(r - 1), g[r - 1].insert(r);
  return g;
}

Graph ring(int ranks) {
  Graph g = chain(ranks);
  g[0].insert(ranks - 1), g[ranks - 1].insert(0);
  return g;
}

Graph complete(int ranks) {
  Graph g(ranks);
  for (int r = 0; r < ranks; ++r)
    for (int s = 0; s < ranks; ++s)
      if (s != r) g[r].insert(s);
  return g;
}

/// Ranks of a cube of blocks that touch at faces.
Graph cube(int edge) {
  Graph g(edge * edge * edge);
  for (int r = 0; r < int(g.size()); ++r)
    for (const int step : {1, edge, edge * edge}) {
      if ((r / step) % edge == edge - 1) continue;
      g[r].insert(r + step), g[r + step].insert(r);
    }
  return g;
}

/// So many links between ranks drawn at random: some clusters, some ranks alone.
Graph random_graph(int ranks, int links, unsigned seed) {
  std::mt19937 random(seed);
  Graph g(ranks);
  for (int k = 0; k < links; ++k) {
    const int r = int(random() % ranks), s = int(random() % ranks);
    if (r != s) g[r].insert(s), g[s].insert(r);
  }
  return g;
}

/// The numbers of the ranks given anew.
Graph shuffled(const Graph& g, unsigned seed) {
  std::vector<int> name(g.size());
  for (int r = 0; r < int(g.size()); ++r) name[r] = r;
  std::shuffle(name.begin(), name.end(), std::mt19937(seed));
  Graph renamed(g.size());
  for (int r = 0; r < int(g.size()); ++r)
    for (const int s : g[r]) renamed[name[r]].insert(name[s]);
  return renamed;
}

/// Links between a rank and each other; -1 where none lead there.
std::vector<int> distances(const Graph& g, int from) {
  std::vector<int> d(g.size(), -1), front{from};
  d[from] = 0;
  while (!front.empty()) {
    std::vector<int> next;
    for (const int r : front)
      for (const int s : g[r])
        if (d[s] < 0) d[s] = d[r] + 1, next.push_back(s);
    front = next;
  }
  return d;
}

/// Each rank begins to say 0 in some round, 1 before, and hands on the least it has heard. Whenever a rank
/// takes what was said for known to all, it is, and everyone in its cluster says so in the same round.
void expect_agreement(const Graph& g) {
  const int ranks = int(g.size());
  std::vector<EchoReduction> clusters(ranks);
  std::vector<std::vector<int>> distance;
  for (int r = 0; r < ranks; ++r) {
    clusters[r].begin(r, {g[r].begin(), g[r].end()}, ranks);
    distance.push_back(distances(g, r));
  }
  const auto farthest = [&](int r) { return *std::max_element(distance[r].begin(), distance[r].end()); };
  const auto leader = [&](int r) {
    return int(std::find_if(distance[r].begin(), distance[r].end(), [](int d) { return d >= 0; }) -
               distance[r].begin());
  };
  std::vector<int> known(ranks, -1);  // in which round a word of the first round was known to all
  for (int round = 0; round <= 2 * ranks; ++round) {
    for (int r = 0; r < ranks; ++r) {
      if (known[r] < 0 && clusters[r].is_complete(round)) known[r] = round;
      for (int s = 0; s < ranks; ++s) {
        if (distance[r][s] < 0) continue;
        for (int ago = 0; ago < ranks; ++ago)
          ASSERT_EQ(clusters[r].is_complete(ago), clusters[s].is_complete(ago))
              << "ranks " << r << " and " << s << ", round " << round << ", " << ago << " ago";
      }
    }
    std::vector<EchoReduction::Message> words;
    for (int r = 0; r < ranks; ++r) words.push_back(clusters[r].message(r));
    for (int r = 0; r < ranks; ++r) {
      std::vector<EchoReduction::Message> heard;
      int least = r;
      for (const int s : g[r]) heard.push_back(words[s]), least = std::min(least, s);
      EXPECT_EQ(clusters[r].receive(r, heard), least);
    }
  }
  for (int r = 0; r < ranks; ++r) {
    ASSERT_GE(known[r], farthest(r));
    const int depth = farthest(leader(r));
    EXPECT_LE(known[r], std::min(3 * depth + 2, ranks - 1));
    const int across = known[r] < ranks - 1 ? 2 * depth : ranks - 1;
    if (depth > 0) {
      EXPECT_TRUE(clusters[r].is_complete(across));
    }
    EXPECT_FALSE(farthest(r) > 0 && clusters[r].is_complete(farthest(r) - 1));
  }
}

TEST(EchoReduction, AgreesOnAnyGraph) {
  for (const int ranks : {1, 2, 3, 8, 27}) {
    expect_agreement(chain(ranks));
    expect_agreement(complete(ranks));
    if (ranks > 2) expect_agreement(ring(ranks));
  }
  for (unsigned seed = 0; seed < 8; ++seed) {
    expect_agreement(shuffled(chain(20), seed));
    expect_agreement(shuffled(cube(3), seed));
    expect_agreement(random_graph(30, 10 + 8 * int(seed), seed));
  }
}

/// 64 ranks, each with its neighbours: a word reaches all in 9 rounds, where only the number of ranks would
/// ask for 63.
TEST(EchoReduction, NeedsRoundsForHowFarAcrossItIsNotForHowManyItHas) {
  const Graph g = cube(4);
  std::vector<EchoReduction> clusters(64);
  for (int r = 0; r < 64; ++r) clusters[r].begin(r, {g[r].begin(), g[r].end()}, 64);
  int rounds = 0;
  for (; !clusters[63].is_complete(rounds); ++rounds) {
    std::vector<EchoReduction::Message> words;
    for (int r = 0; r < 64; ++r) words.push_back(clusters[r].message(0));
    for (int r = 0; r < 64; ++r) {
      std::vector<EchoReduction::Message> heard;
      for (const int s : g[r]) heard.push_back(words[s]);
      clusters[r].receive(0, heard);
    }
  }
  EXPECT_LE(rounds, 3 * 9 + 2);
  EXPECT_TRUE(clusters[0].is_complete(2 * 9));
  EXPECT_FALSE(clusters[0].is_complete(8));
}

}  // namespace
}  // namespace silt::rigid

// What ranks agree on by words between neighbours, against the graph of them, looked at from above.
#include "rigid/bodies/body_exchange.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace silt::rigid {
namespace {

using Graph = std::vector<std::set<int>>;

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
  std::vector<RankCluster> clusters(ranks);
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
      if (known[r] < 0 && clusters[r].all_have_heard(round)) known[r] = round;
      for (int s = 0; s < ranks; ++s) {
        if (distance[r][s] < 0) continue;
        for (int ago = 0; ago < ranks; ++ago)
          ASSERT_EQ(clusters[r].all_have_heard(ago), clusters[s].all_have_heard(ago))
              << "ranks " << r << " and " << s << ", round " << round << ", " << ago << " ago";
      }
    }
    std::vector<RankCluster::Word> words;
    for (int r = 0; r < ranks; ++r) words.push_back(clusters[r].say(r));
    for (int r = 0; r < ranks; ++r) {
      std::vector<RankCluster::Word> heard;
      int least = r;
      for (const int s : g[r]) heard.push_back(words[s]), least = std::min(least, s);
      EXPECT_EQ(clusters[r].hear(r, heard), least);
    }
  }
  for (int r = 0; r < ranks; ++r) {
    ASSERT_GE(known[r], farthest(r));
    const int depth = farthest(leader(r));
    EXPECT_LE(known[r], std::min(3 * depth + 2, ranks - 1));
    const int across = known[r] < ranks - 1 ? 2 * depth : ranks - 1;
    if (depth > 0) {
      EXPECT_TRUE(clusters[r].all_have_heard(across));
    }
    EXPECT_FALSE(farthest(r) > 0 && clusters[r].all_have_heard(farthest(r) - 1));
  }
}

TEST(RankCluster, AgreesOnAnyGraph) {
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
TEST(RankCluster, NeedsRoundsForHowFarAcrossItIsNotForHowManyItHas) {
  const Graph g = cube(4);
  std::vector<RankCluster> clusters(64);
  for (int r = 0; r < 64; ++r) clusters[r].begin(r, {g[r].begin(), g[r].end()}, 64);
  int rounds = 0;
  for (; !clusters[63].all_have_heard(rounds); ++rounds) {
    std::vector<RankCluster::Word> words;
    for (int r = 0; r < 64; ++r) words.push_back(clusters[r].say(0));
    for (int r = 0; r < 64; ++r) {
      std::vector<RankCluster::Word> heard;
      for (const int s : g[r]) heard.push_back(words[s]);
      clusters[r].hear(0, heard);
    }
  }
  EXPECT_LE(rounds, 3 * 9 + 2);
  EXPECT_TRUE(clusters[0].all_have_heard(2 * 9));
  EXPECT_FALSE(clusters[0].all_have_heard(8));
}

}  // namespace
}  // namespace silt::rigid

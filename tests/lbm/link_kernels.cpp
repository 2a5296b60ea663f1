// The kernels of cut links: what returns does not depend on what is fetched or how their distances change,
// and their resistance is how the force falls with the velocity.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "lbm/walls/cut_links.hpp"

namespace silt::lbm {
namespace {

constexpr int width = 24;   // cells of the block in x and y
constexpr int spacing = 4;  // cells between walls, so that the links of none meet another
constexpr std::uint32_t links_of_wall[] = {1, 7, 64, 65, 129, 300, 8};  // up to 128 are fetched ahead
constexpr int walls = int(std::size(links_of_wall));

template <class T>
void hold_excess(Block<T>& block) {
  block.hold_excess({0, block.size().y, 0, block.size().z}, 0);
}
template <class T>
std::vector<ExcessQuanta<T>> excess_of(Block<T>& block) {
  return {block.excess(), block.excess() + block.cell(block.size() - Int3{1, 1, 1})};
}

/// Walls above as many planes of cells, a group of links each.
template <class T>
CutLinks<T> walls_above_planes(WallScheme scheme) {
  CutLinks<T> links;
  links.frame = {{width / 2, width / 2, 0}, {0.2, -0.3, 0.1}, 40, true};
  for (int wall = 0; wall < walls; ++wall) {
    const LinkGroup group{
        std::uint32_t(links.place.size()), links_of_wall[wall], scheme, {0, 0, 2 + wall * spacing}, 0};
    for (std::uint32_t left = group.count, n = 0; left > 0; ++n) {
      const int i = 1 + int(n) % (D3Q19::directions - 1), cell = int(n) / (D3Q19::directions - 1);
      if (D3Q19::c[i].z != 1) continue;
      links.place.push_back(link_place({1 + cell % (width - 2), 1 + cell / (width - 2), 0}, i)), --left;
      links.q.push_back(T(0.05 + 0.9 * ((n * 7 + unsigned(wall)) % 31) / 31.0));
    }
    links.place.resize(group.begin + padded(group.count), links.place.back());
    links.q.resize(links.place.size(), links.q.back());
    links.groups.push_back(group);
  }
  return links;
}

template <class T>
struct Returned {
  std::vector<T> populations;
  std::vector<std::int64_t> sums;
  std::vector<ExcessQuanta<T>> excess;
  bool operator==(const Returned&) const = default;
};

/// All groups in turn; if they fetch, each names the one that many places further on as the next.
template <class T>
Returned<T> applied(const CutLinks<T>& links, int next, bool fetch) {
  const SurfaceMotion motion{{0.01, -0.02, 0.03}, {1e-3, 2e-3, -1e-3}};
  Block<T> block({{0, 0, 0}, {width, width, walls * spacing}});
  for (std::size_t k = 0; k < block.bytes() / sizeof(T); ++k)
    block.data()[k] = T(0.01 * std::sin(double(k) * 0.7));
  hold_excess(block);
  const LinkSlots slots = link_slots(block, Parity::settled);
  Returned<T> all;
  for (int wall = 0; wall < walls; ++wall) {
    NextGroup<T> named;
    if (fetch && wall + next < walls) named = {&links, &links.groups[wall + next]};
    LinkSums sums;
    const GroupInBlock<T> here{block, slots, links, links.groups[wall], named, nullptr, fetch};
    apply_cut_links<T>(here, motion, ForceForm::exact, sums);
    all.sums.insert(all.sums.end(), {sums.force[0], sums.force[1], sums.force[2], sums.torque[0],
                                     sums.torque[1], sums.torque[2]});
  }
  all.excess = excess_of(block);
  all.populations.assign(block.data(), block.data() + block.bytes() / sizeof(T));
  return all;
}

template <class T>
void expect_same_however_fetched(WallScheme scheme) {
  SCOPED_TRACE(wall_scheme_names[int(scheme)]);
  const CutLinks<T> links = walls_above_planes<T>(scheme);
  const Returned<T> alone = applied(links, 0, false);
  EXPECT_NE(alone.sums, std::vector<std::int64_t>(alone.sums.size(), 0));
  EXPECT_EQ(applied(links, 1, true), alone) << "each group fetches for the one after it";
  EXPECT_EQ(applied(links, 2, true), alone) << "each group fetches for one that does not come next";
}

TEST(LinkFetch, WhatReturnsIsTheSameHoweverLinksAreFetched) {
  for (const WallScheme scheme :
       {WallScheme::bounce_back, WallScheme::cli, WallScheme::parabolic, WallScheme::multireflection}) {
    expect_same_however_fetched<float>(scheme);
    expect_same_however_fetched<double>(scheme);
  }
}

constexpr int block_edge = 24;  // cells of the block

/// Above a plane of cells; some distances come to lie a little outside of [0, 1].
template <class T>
CutLinks<T> links_that_change(WallScheme scheme) {
  CutLinks<T> links;
  links.frame = {{block_edge / 2, block_edge / 2, 0}, {0.2, -0.3, 0.1}, 40, true};
  const LinkGroup group{0, 301, scheme, {0, 0, 5}, 0};
  for (std::uint32_t n = 0; links.place.size() < group.count; ++n) {
    const int i = 1 + int(n) % (D3Q19::directions - 1), cell = int(n) / (D3Q19::directions - 1);
    if (D3Q19::c[i].z != 1) continue;
    links.place.push_back(link_place({1 + cell % (block_edge - 2), 1 + cell / (block_edge - 2), 0}, i));
    links.q.push_back(T(double((n * 7) % 31) / 30));
    links.rate.push_back(T(0.02 * std::sin(double(n))));
  }
  const std::size_t all = padded(group.count);
  links.place.resize(all, links.place.back());
  links.q.resize(all, links.q.back()), links.rate.resize(all, links.rate.back());
  links.groups.push_back(group);
  return links;
}

template <class T>
struct Result {
  std::vector<T> populations;
  std::vector<ExcessQuanta<T>> excess;
  LinkSums applied;
};

template <class T>
Result<T> result_of(const CutLinks<T>& links) {
  const SurfaceMotion motion{{0.01, -0.02, 0.03}, {1e-3, 2e-3, -1e-3}};
  Block<T> block({{0, 0, 0}, {block_edge, block_edge, block_edge}});
  for (std::size_t k = 0; k < block.bytes() / sizeof(T); ++k)
    block.data()[k] = T(0.01 * std::sin(double(k) * 0.7));
  hold_excess(block);
  const LinkSlots slots = link_slots(block, Parity::settled);
  Result<T> all;
  const GroupInBlock<T> here{block, slots, links, links.groups[0]};
  apply_cut_links<T>(here, motion, ForceForm::galilean, all.applied);
  correct_cut_links<T>(here, motion);
  all.excess = excess_of(block);
  all.populations.assign(block.data(), block.data() + block.bytes() / sizeof(T));
  return all;
}

template <class T>
void expect_what_links_at_these_distances_return(WallScheme scheme, T age) {
  SCOPED_TRACE(std::string(wall_scheme_names[int(scheme)]) + " at " + std::to_string(age));
  CutLinks<T> changing = links_that_change<T>(scheme);
  changing.age = age;
  CutLinks<T> held = changing;
  held.rate.clear(), held.age = 0;
  for (std::size_t l = 0; l < held.q.size(); ++l) held.q[l] += age * changing.rate[l];
  EXPECT_EQ(held.q == changing.q, age == 0);
  const Result<T> a = result_of(changing), b = result_of(held);
  EXPECT_EQ(a.populations, b.populations);
  EXPECT_EQ(a.excess, b.excess);
  EXPECT_TRUE(
      std::equal(std::begin(a.applied.force), std::end(a.applied.force), std::begin(b.applied.force)));
  EXPECT_TRUE(
      std::equal(std::begin(a.applied.torque), std::end(a.applied.torque), std::begin(b.applied.torque)));
}

TEST(LinkRates, LinksReturnWhatThoseAtTheirDistancesDo) {
  for (const WallScheme scheme : {WallScheme::cli, WallScheme::parabolic, WallScheme::multireflection})
    for (const double age : {-3.5, 0.0, 0.5, 4.0}) {
      expect_what_links_at_these_distances_return<float>(scheme, float(age));
      expect_what_links_at_these_distances_return<double>(scheme, age);
    }
}

constexpr int edge = 40;

/// A flat wall above the plane z = 3 of a block: five links from each of its inner cells, at distances that
/// differ, thousands in one group.
template <class T>
CutLinks<T> wall_links(WallScheme scheme) {
  CutLinks<T> links;
  links.frame = {{edge / 2, edge / 2, 5}, {0.21, -0.34, 0.17}, 40, true};
  for (int i = 1; i < D3Q19::directions; ++i)
    for (int y = 1; D3Q19::c[i].z == 1 && y < edge - 1; ++y)
      for (int x = 1; x < edge - 1; ++x) {
        links.place.push_back(link_place({x, y, 0}, i));
        links.q.push_back(T(0.05 + 0.9 * ((x * 7 + y * 13 + i) % 31) / 31.0));
      }
  const auto count = std::uint32_t(links.place.size());
  links.place.resize(padded(count), links.place.back()), links.q.resize(links.place.size(), links.q.back());
  links.groups.push_back({0, count, scheme, {0, 0, 3}, 0});
  return links;
}

constexpr double small = 1e-3;  // velocity, angular velocity

/// Force and torque of the links of a fluid at rest (no deviations) on a wall that moves.
template <class T>
std::array<double, 6> force_of(const CutLinks<T>& links, const SurfaceMotion& motion) {
  Block<T> block({{0, 0, 0}, {edge, edge, 8}});
  hold_excess(block);
  LinkSums sums;
  const LinkSlots slots = link_slots(block, Parity::settled);
  apply_cut_links<T>({block, slots, links, links.groups[0]}, motion, ForceForm::exact, sums);
  EXPECT_FALSE(sums.invalid);
  std::array<double, 6> force;
  for (int d = 0; d < 3; ++d)
    force[d] = double(sums.force[d]) * link_quantum, force[3 + d] = double(sums.torque[d]) * link_quantum;
  return force;
}

/// Each link's term of the force is off by half its quantum, that of the resistance by two of its own.
template <class T>
void expect_slope_of_force(WallScheme scheme) {
  const CutLinks<T> passing = wall_links<T>(WallScheme::bounce_back);  // the mass of the motion alone
  constexpr double rounding = link_quantum / (2 * small) + 2 * resistance_quantum<T>;
  const CutLinks<T> links = wall_links<T>(scheme);
  const int exponent = resistance_exponent(links.frame.reach);
  const ResistanceSums sums = resistance_of(links, exponent);
  int e = 0;
  for (int a = 0; a < 6; ++a)
    for (int b = a; b < 6; ++b, ++e) {
      SurfaceMotion motion;
      (b < 3 ? motion.v : motion.omega)[b % 3] = small;
      const double arms = std::ldexp(1.0, exponent * ((a >= 3) + (b >= 3)));
      EXPECT_NEAR(double(sums.h[e]) * resistance_quantum<T> * arms, -force_of(passing, motion)[a] / small,
                  rounding * double(links.place.size()) * arms)
          << "row " << a << ", column " << b;
    }
}

TEST(LinkResistance, IsHowTheForceFallsWithTheVelocityUnderBounceBack) {
  for (const WallScheme scheme :
       {WallScheme::bounce_back, WallScheme::cli, WallScheme::parabolic, WallScheme::multireflection}) {
    SCOPED_TRACE(wall_scheme_names[int(scheme)]);
    expect_slope_of_force<double>(scheme);
    expect_slope_of_force<float>(scheme);
  }
}

}  // namespace
}  // namespace silt::lbm

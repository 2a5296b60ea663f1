// What surfaces return depends neither on whether links are listed ahead of their turn, nor on whether the
// group that was named to come next is the one that does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "lbm/cut_links.hpp"

namespace silt::lbm {
namespace {

constexpr int side = 24;    // cells of the block in x and y
constexpr int spacing = 4;  // cells between walls, so that the links of none meet another
constexpr std::uint32_t links_of_wall[] = {1, 7, 64, 65, 129, 300, 8};  // some fit a window, others do not
constexpr int walls = int(std::size(links_of_wall));

/// Walls above as many planes of cells, a group of links each.
template <class T>
CutLinks<T> walls_above_planes(WallScheme scheme) {
  CutLinks<T> links;
  links.frame = {{side / 2, side / 2, 0}, {0.2, -0.3, 0.1}, 40, true};
  for (int wall = 0; wall < walls; ++wall) {
    const LinkGroup group{
        std::uint32_t(links.place.size()), links_of_wall[wall], scheme, {0, 0, 2 + wall * spacing}, 0};
    for (std::uint32_t left = group.count, n = 0; left > 0; ++n) {
      const int i = 1 + int(n) % (directions - 1), cell = int(n) / (directions - 1);
      if (c[i].z != 1) continue;
      links.place.push_back(link_place({1 + cell % (side - 2), 1 + cell / (side - 2), 0}, i)), --left;
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
  bool operator==(const Returned&) const = default;
};

/// All groups in turn, each of which names the one that many places further on as the next.
template <class T>
Returned<T> applied(const CutLinks<T>& links, int next, ListedLinks* listed) {
  const SurfaceMotion motion{{0.01, -0.02, 0.03}, {1e-3, 2e-3, -1e-3}};
  Block<T> block({{0, 0, 0}, {side, side, walls * spacing}});
  for (std::size_t k = 0; k < block.bytes() / sizeof(T); ++k)
    block.data()[k] = T(0.01 * std::sin(double(k) * 0.7));
  const LinkSlots slots = link_slots(block, Parity::settled);
  Returned<T> all;
  for (int wall = 0; wall < walls; ++wall) {
    NextGroup<T> named;
    if (listed && wall + next < walls) named = {&links, &links.groups[wall + next]};
    LinkSums sums;
    const GroupInBlock<T> here{block, slots, links, links.groups[wall], named, nullptr, listed};
    apply_cut_links<T>(here, motion, ForceForm::exact, sums);
    all.sums.insert(all.sums.end(), {sums.force[0], sums.force[1], sums.force[2], sums.torque[0],
                                     sums.torque[1], sums.torque[2], sums.mass});
  }
  all.populations.assign(block.data(), block.data() + block.bytes() / sizeof(T));
  return all;
}

template <class T>
void expect_same_however_listed(WallScheme scheme) {
  SCOPED_TRACE(wall_scheme_names[int(scheme)]);
  const CutLinks<T> links = walls_above_planes<T>(scheme);
  const Returned<T> alone = applied(links, 0, nullptr);
  EXPECT_NE(alone.sums, std::vector<std::int64_t>(alone.sums.size(), 0));
  ListedLinks listed;
  EXPECT_EQ(applied(links, 1, &listed), alone) << "each group lists the one after it";
  EXPECT_EQ(applied(links, 2, &listed), alone) << "each group lists one that does not come next";
}

TEST(LinkFetch, WhatReturnsIsTheSameHoweverLinksAreListed) {
  for (const WallScheme scheme :
       {WallScheme::bounce_back, WallScheme::cli, WallScheme::parabolic, WallScheme::multireflection}) {
    expect_same_however_listed<float>(scheme);
    expect_same_however_listed<double>(scheme);
  }
}

}  // namespace
}  // namespace silt::lbm

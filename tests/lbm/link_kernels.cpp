// The kernels of cut links: what returns does not depend on how links are listed or their distances change,
// and their resistance is how the force falls with the velocity.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "lbm/walls/cut_links.hpp"

namespace silt::lbm {
namespace {

constexpr int width = 40;   // cells of a block in x and y
constexpr int spacing = 4;  // cells between walls, so that the links of none meet another

/// Walls above planes of cells, a group of so many links each, at distances that differ.
template <class T>
CutLinks<T> walls_above_planes(WallScheme scheme, std::initializer_list<std::uint32_t> counts) {
  CutLinks<T> links;
  links.frame = {{width / 2, width / 2, 0}, {0.2, -0.3, 0.1}, 40, true};
  for (const std::uint32_t count : counts) {
    const int wall = int(links.groups.size());
    const LinkGroup group{std::uint32_t(links.place.size()), count, scheme, {0, 0, 2 + wall * spacing}, 0};
    for (std::uint32_t n = 0; links.place.size() < group.begin + count; ++n) {
      const int i = 1 + int(n) % (D3Q19::directions - 1), cell = int(n) / (D3Q19::directions - 1);
      if (D3Q19::c[i].z != 1) continue;
      links.place.push_back(link_place({1 + cell % (width - 2), 1 + cell / (width - 2), 0}, i));
      links.q.push_back(T(0.05 + 0.9 * ((n * 7 + unsigned(wall)) % 31) / 31.0));
    }
    links.place.resize(group.begin + padded(count), links.place.back());
    links.q.resize(links.place.size(), links.q.back());
    links.groups.push_back(group);
  }
  return links;
}

/// A block under so many walls, which holds excess.
template <class T>
Block<T> block_under(std::size_t walls) {
  Block<T> block({{}, {width, width, int(walls) * spacing + spacing}});
  block.hold_excess({0, block.size().y, 0, block.size().z}, 0);
  return block;
}

template <class T>
struct Returned {
  std::vector<T> populations;
  std::vector<ExcessQuanta<T>> excess;
  std::vector<std::int64_t> sums;
  bool operator==(const Returned&) const = default;
};

/// What stirred fluid has after all groups in turn, each of which names the one that many places further on
/// as the next.
template <class T>
Returned<T> returned(const CutLinks<T>& links, int next = 0, ListedLinks* listed = nullptr) {
  const SurfaceMotion motion{{0.01, -0.02, 0.03}, {1e-3, 2e-3, -1e-3}};
  Block<T> block = block_under<T>(links.groups.size());
  for (std::size_t k = 0; k < block.bytes() / sizeof(T); ++k)
    block.data()[k] = T(0.01 * std::sin(double(k) * 0.7));
  const LinkSlots slots = link_slots(block, Parity::settled);
  Returned<T> all;
  for (std::size_t wall = 0; wall < links.groups.size(); ++wall) {
    NextGroup<T> named;
    if (listed && wall + next < links.groups.size()) named = {&links, &links.groups[wall + next]};
    LinkSums sums;
    const GroupInBlock<T> here{block, slots, links, links.groups[wall], named, nullptr, listed};
    apply_cut_links<T>(here, motion, ForceForm::galilean, sums);
    correct_cut_links<T>({block, slots, links, links.groups[wall]}, motion);
    for (const auto& sum : {sums.force, sums.torque}) all.sums.insert(all.sums.end(), sum, sum + 3);
  }
  all.excess.assign(block.excess(), block.excess() + block.cell(block.size() - Int3{1, 1, 1}));
  all.populations.assign(block.data(), block.data() + block.bytes() / sizeof(T));
  return all;
}

template <class T>
void expect_same_however_listed(WallScheme scheme) {
  SCOPED_TRACE(wall_scheme_names[int(scheme)]);
  // some fit a window, others do not
  const CutLinks<T> links = walls_above_planes<T>(scheme, {1, 7, 64, 65, 129, 300, 8});
  const Returned<T> alone = returned(links);
  EXPECT_NE(alone.sums, std::vector<std::int64_t>(alone.sums.size(), 0));
  ListedLinks listed;
  EXPECT_EQ(returned(links, 1, &listed), alone) << "each group lists the one after it";
  EXPECT_EQ(returned(links, 2, &listed), alone) << "each group lists one that does not come next";
}

TEST(LinkFetch, WhatReturnsIsTheSameHoweverLinksAreListed) {
  for (const WallScheme scheme :
       {WallScheme::bounce_back, WallScheme::cli, WallScheme::parabolic, WallScheme::multireflection}) {
    expect_same_however_listed<float>(scheme);
    expect_same_however_listed<double>(scheme);
  }
}

/// Some distances come to lie a little outside of [0, 1].
template <class T>
void expect_what_links_at_these_distances_return(WallScheme scheme, T age) {
  SCOPED_TRACE(std::string(wall_scheme_names[int(scheme)]) + " at " + std::to_string(age));
  CutLinks<T> changing = walls_above_planes<T>(scheme, {301});
  for (std::size_t l = 0; l < changing.q.size(); ++l) {
    changing.q[l] = (changing.q[l] - T(0.05)) / T(0.87);
    changing.rate.push_back(T(0.02 * std::sin(double(l))));
  }
  changing.age = age;
  CutLinks<T> held = changing;
  held.rate.clear(), held.age = 0;
  for (std::size_t l = 0; l < held.q.size(); ++l) held.q[l] += age * changing.rate[l];
  EXPECT_EQ(held.q == changing.q, age == 0);
  EXPECT_EQ(returned(changing), returned(held));
}

TEST(LinkRates, LinksReturnWhatThoseAtTheirDistancesDo) {
  for (const WallScheme scheme : {WallScheme::cli, WallScheme::parabolic, WallScheme::multireflection})
    for (const double age : {-3.5, 0.0, 0.5, 4.0}) {
      expect_what_links_at_these_distances_return<float>(scheme, float(age));
      expect_what_links_at_these_distances_return<double>(scheme, age);
    }
}

/// A flat wall above a plane: five links from each of its inner cells, thousands in one group.
template <class T>
CutLinks<T> wall_links(WallScheme scheme) {
  CutLinks<T> links = walls_above_planes<T>(scheme, {5 * (width - 2) * (width - 2)});
  links.frame = {{width / 2, width / 2, 4}, {0.21, -0.34, 0.17}, 40, true};
  return links;
}

constexpr double small = 1e-3;  // velocity, angular velocity

/// Force and torque of the links of a fluid at rest (no deviations) on a wall that moves.
template <class T>
std::array<double, 6> force_of(const CutLinks<T>& links, const SurfaceMotion& motion) {
  Block<T> block = block_under<T>(1);
  LinkSums sums;
  const LinkSlots slots = link_slots(block, Parity::settled);
  apply_cut_links<T>({block, slots, links, links.groups[0]}, motion, ForceForm::exact, sums);
  EXPECT_FALSE(sums.invalid);
  std::array<double, 6> force;
  for (int d = 0; d < 3; ++d)
    force[d] = double(sums.force[d]) * link_quantum, force[3 + d] = double(sums.torque[d]) * link_quantum;
  return force;
}

/// In fluid at rest a link under bounce-back returns what its surface pushes and nothing beyond; each gives
/// what the surface owes by it.
template <class T>
void expect_excess_of_what_is_owed() {
  const CutLinks<T> links = wall_links<T>(WallScheme::bounce_back);
  constexpr int owed = 17;  // quanta
  const SurfaceMotion motion{{small, -2 * small, 3 * small}, {small, small, -small}, owed};
  Block<T> block = block_under<T>(1);
  LinkSums sums;
  const LinkSlots slots = link_slots(block, Parity::settled);
  apply_cut_links<T>({block, slots, links, links.groups[0]}, motion, ForceForm::exact, sums);
  std::int64_t given = 0;
  for (std::size_t k = 0; k < block.excess_cells(); ++k) given += block.excess()[k];
  EXPECT_EQ(given, -owed * std::int64_t(links.groups[0].count));
}

TEST(LinkExcess, UnderBounceBackIsWhatTheSurfaceOwes) {
  expect_excess_of_what_is_owed<float>();
  expect_excess_of_what_is_owed<double>();
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

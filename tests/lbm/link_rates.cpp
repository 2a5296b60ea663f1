// Links whose distances change at a rate return what links at these distances do, at any age.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "lbm/cut_links.hpp"

namespace silt::lbm {
namespace {

constexpr int block_edge = 24;  // cells of the block

/// Above a plane of cells; some distances come to lie a little outside of [0, 1].
template <class T>
CutLinks<T> links_that_change(WallScheme scheme) {
  CutLinks<T> links;
  links.frame = {{block_edge / 2, block_edge / 2, 0}, {0.2, -0.3, 0.1}, 40, true};
  const LinkGroup group{0, 301, scheme, {0, 0, 5}, 0};
  for (std::uint32_t n = 0; links.place.size() < group.count; ++n) {
    const int i = 1 + int(n) % (directions - 1), cell = int(n) / (directions - 1);
    if (c[i].z != 1) continue;
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
  LinkSums applied, corrected;
};

template <class T>
Result<T> result_of(const CutLinks<T>& links) {
  const SurfaceMotion motion{{0.01, -0.02, 0.03}, {1e-3, 2e-3, -1e-3}};
  Block<T> block({{0, 0, 0}, {block_edge, block_edge, block_edge}});
  for (std::size_t k = 0; k < block.bytes() / sizeof(T); ++k)
    block.data()[k] = T(0.01 * std::sin(double(k) * 0.7));
  const LinkSlots slots = link_slots(block, Parity::settled);
  Result<T> all;
  const GroupInBlock<T> here{block, slots, links, links.groups[0]};
  apply_cut_links<T>(here, motion, ForceForm::galilean, all.applied);
  correct_cut_links<T>(here, motion, all.corrected);
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
  EXPECT_EQ(a.applied.mass, b.applied.mass);
  EXPECT_EQ(a.corrected.mass, b.corrected.mass);
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

}  // namespace
}  // namespace silt::lbm

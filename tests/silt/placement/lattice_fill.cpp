// Fills on sites: how many, how far apart, and what is left out; and the grid that finds neighbours.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "silt/case/case.hpp"
#include "silt/placement/obstacles.hpp"
#include "tests/errors.hpp"
#include "tests/silt/placement/placed.hpp"

namespace silt::testing {
namespace {

using rigid::BoundingBox;
using rigid::Vec3;

CaseText sites(const std::string& lines, const std::string& boundary = "\"periodic\"") {
  CaseText c;
  c.fluid = "";
  c.domain = domain_of({40, 40, 40}, boundary);
  c.shapes = sphere_of("ball", 4);
  c.bodies = "[[fill]]\nshape = \"ball\"\ndensity = 1\n" + lines;
  return c;
}

std::vector<Vec3> centres_of(const CaseText& c, const Overrides& overrides = {}) {
  std::vector<Vec3> centres;
  for (const BodySpec& body : bodies_of(c.read(overrides))) centres.push_back(body.pose.position);
  return centres;
}

/// The distances from one body to the others, the least first.
std::vector<double> distances(const std::vector<Vec3>& centres, std::size_t from, const Case& setup) {
  std::vector<double> all;
  for (std::size_t i = 0; i < centres.size(); ++i)
    if (i != from) all.push_back(coupler::nearest_image(centres[i] - centres[from], extent_of(setup)).norm());
  std::sort(all.begin(), all.end());
  return all;
}

double least_distance(const std::vector<Vec3>& centres, const Case& setup) {
  double least = 1e9;
  for (std::size_t i = 0; i < centres.size(); ++i) least = std::min(least, distances(centres, i, setup)[0]);
  return least;
}

TEST(LatticeFill, SimpleCubicFillsAPeriodicBox) {
  const CaseText c = sites("arrangement = \"simple-cubic\"\nspacing = 4.9\n");
  const auto centres = centres_of(c);
  ASSERT_EQ(centres.size(), 512u);
  for (const std::size_t i : {0, 100, 511}) {
    const auto d = distances(centres, i, c.read());
    for (int k = 0; k < 6; ++k) EXPECT_NEAR(d[k], 5, 1e-12);
    EXPECT_NEAR(d[6], 5 * std::numbers::sqrt2, 1e-12);
  }
}

TEST(LatticeFill, SimpleCubicStandsInTheMiddleBetweenWalls) {
  const auto centres =
      centres_of(sites("arrangement = \"simple-cubic\"\nspacing = 5\ngap = 0.5\n", "\"no-slip\""));
  ASSERT_EQ(centres.size(), 512u);  // 35 cells for centres: 8 sites
  EXPECT_NEAR((centres.front() - Vec3::Constant(2.5)).norm(), 0, 1e-12);
  EXPECT_NEAR((centres.back() - Vec3::Constant(37.5)).norm(), 0, 1e-12);
  EXPECT_NEAR((centres[1] - centres[0] - Vec3(5, 0, 0)).norm(), 0, 1e-12) << "ids go along x first";
}

/// Twelve neighbours touch; a large box is 74 % full.
TEST(LatticeFill, HexagonalIsTheClosestPacking) {
  CaseText c = sites("arrangement = \"hexagonal\"\n", "\"no-slip\"");
  const auto centres = centres_of(c);
  const Case setup = c.read();
  EXPECT_NEAR(least_distance(centres, setup), 4, 1e-9);
  std::size_t inner = 0;
  for (std::size_t i = 0; i < centres.size(); ++i) {
    if ((centres[i] - Vec3::Constant(20)).cwiseAbs().maxCoeff() > 13) continue;
    const auto d = distances(centres, i, setup);
    EXPECT_NEAR(d[11], 4, 1e-9);
    EXPECT_NEAR(d[12], 4 * std::numbers::sqrt2, 1e-9);
    ++inner;
  }
  EXPECT_GT(inner, 200u);
  c.domain = domain_of({200, 194, 196});  // 50 bodies a row, 56 rows a layer, 60 layers
  const double filled = centres_of(c).size() * 4. / 3 * std::numbers::pi * 8 / (200. * 194 * 196);
  EXPECT_NEAR(filled, std::numbers::pi / std::sqrt(18), 1e-3);
}

TEST(LatticeFill, ShiftedBodiesKeepTheGap) {
  for (const char* arrangement : {"simple-cubic", "hexagonal"})
    for (const char* boundary : {"\"periodic\"", "\"no-slip\""}) {
      const CaseText c =
          sites(std::string("arrangement = \"") + arrangement + "\"\ngap = 0.5\nshift = 0.7\n", boundary);
      const auto centres = centres_of(c);
      const double least = least_distance(centres, c.read());
      EXPECT_GE(least, 4.5) << arrangement << boundary;
      EXPECT_LT(least, 5.6) << "they are not shifted: " << arrangement << boundary;
      for (const Vec3& x : centres)
        if (boundary[1] == 'n') {
          EXPECT_GE(x.minCoeff(), 2.5);
          EXPECT_LE(x.maxCoeff(), 37.5);
        }
    }
}

TEST(LatticeFill, TakenSitesAreLeftOut) {
  CaseText c = sites("arrangement = \"simple-cubic\"\nspacing = 5\n");
  c.bodies = body_of("ball", 1, "position = [20, 20, 20]") + c.bodies;  // amid eight sites, 4.33 away
  EXPECT_EQ(centres_of(c).size(), 513u);
  EXPECT_EQ(centres_of(c, {"fill[0].gap=0.5"}).size(), 505u);
}

TEST(LatticeFill, CountTakesTheLowest) {
  const auto centres = centres_of(sites("arrangement = \"simple-cubic\"\nspacing = 5\ncount = 70\n"));
  ASSERT_EQ(centres.size(), 70u);
  EXPECT_NEAR(centres.back()[2], 7.5, 1e-12);
  EXPECT_NEAR(centres[63][2], 2.5, 1e-12);
}

TEST(LatticeFill, SaysHowManySitesThereAre) {
  const CaseText c = sites("arrangement = \"simple-cubic\"\nspacing = 5\ncount = 513\n");
  EXPECT_TEXT(c.fault(),
              "fill[0].count is 513, but there are only 512 free sites; lower count, gap or spacing, or "
              "enlarge box or domain");
}

/// Returns whether two intervals meet, in an image along a periodic axis.
bool meet(double low_a, double high_a, double low_b, double high_b, double length, bool periodic) {
  for (int k = periodic ? -2 : 0; k <= (periodic ? 2 : 0); ++k)
    if (low_a + k * length <= high_b && low_b <= high_a + k * length) return true;
  return false;
}

bool touch(const BoundingBox& a, const BoundingBox& b, const rigid::Extent& extent) {
  for (int d = 0; d < 3; ++d)
    if (!meet(a.lower[d], a.upper[d], b.lower[d], b.upper[d], extent.size[d], extent.periodic[d]))
      return false;
  return true;
}

TEST(NeighbourGrid, FindsAllThatTouch) {
  const rigid::Extent extent{Vec3(40, 13, 25), {true, false, true}};
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> place(0, 1);
  for (const double edge : {0.7, 3.0, 50.0}) {
    std::vector<BoundingBox> boxes;
    NeighbourGrid grid(extent, edge);
    for (int i = 0; i < 300; ++i) {
      Vec3 centre, half;
      for (int d = 0; d < 3; ++d) centre[d] = extent.size[d] * (1.2 * place(engine) - 0.1);
      const double size = i % 50 == 0 ? 12 : 1;  // a few in very many cells
      for (int d = 0; d < 3; ++d) half[d] = size * place(engine);
      boxes.push_back(BoundingBox::around(centre, half));
      std::set<int> found;
      grid.visit(boxes.back(), [&](int k) { return found.insert(k), true; });
      for (int k = 0; k < i; ++k)
        EXPECT_TRUE(found.count(k) || !touch(boxes[k], boxes[i], extent)) << k << " and " << i;
      grid.insert(i, boxes.back());
    }
  }
}

TEST(NeighbourGrid, LeavesOutWhatIsFar) {
  const rigid::Extent extent{Vec3(1000, 1000, 1000), {false, false, false}};
  NeighbourGrid grid(extent, 2);
  for (int i = 0; i < 1000; ++i) grid.insert(i, BoundingBox::around(Vec3(i, i, i), Vec3::Constant(0.5)));
  int looked_at = 0;
  grid.visit(BoundingBox::around(Vec3(500, 500, 500), Vec3::Constant(0.5)),
             [&](int) { return ++looked_at, true; });
  EXPECT_LE(looked_at, 12);
}

}  // namespace
}  // namespace silt::testing

// Random fills: the same for the same seed, no overlaps, inside their boxes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "rigid/collision/tube_contacts.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case.hpp"
#include "silt/case/case_check.hpp"
#include "silt/case/fill_room.hpp"
#include "silt/placement/obstacles.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/silt/placement/placed.hpp"

namespace silt::testing {
namespace {

using rigid::Vec3;

TEST(Fill, GivenBodiesFirstThenEveryFill) {
  const auto bodies = bodies_of(with_fills().read());
  ASSERT_EQ(bodies.size(), 45u);
  EXPECT_EQ(bodies[0].entry, 0);
  EXPECT_EQ(bodies[1].entry, -1);
  EXPECT_EQ(bodies[1].shape, 1);
  EXPECT_EQ(bodies[1].density, 0.8);
  EXPECT_EQ(bodies[1].kind, 1);
  EXPECT_EQ(bodies[44].kind, 2);
}

TEST(Fill, IsTheSameEachTimeAndAnotherForAnotherSeed) {
  const Case setup = with_fills().read();
  const auto a = bodies_of(setup), b = bodies_of(setup);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].pose.position, b[i].pose.position);
    EXPECT_EQ(a[i].pose.orientation.coeffs(), b[i].pose.orientation.coeffs());
  }
  const auto other = bodies_of(with_fills().read({"fill[0].seed=4"}));
  EXPECT_NE(a[1].pose.position, other[1].pose.position);
}

TEST(Fill, SequenceIsPinned) {  // a case must give the same scene with every version: this may only change on
                                // purpose
  const Case setup = with_fills().read();
  const auto bodies = bodies_of(setup);
  const auto origin = [&](const BodySpec& b) { return b.pose.to_world(setup.shape_origins[b.shape]); };
  EXPECT_NEAR(origin(bodies[1])[0], 4.3070675527453481, 1e-9);
  EXPECT_NEAR(origin(bodies[44])[2], 23.091747563900142, 1e-9);
}

TEST(Fill, NothingOverlaps) {
  const Case setup = with_fills().read();
  const auto bodies = bodies_of(setup);
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_LE(overlap_depth(setup.shapes[bodies[i].shape], bodies[i].pose, setup.shapes[bodies[j].shape],
                              bodies[j].pose, extent_of(setup)),
                1e-9)
          << i << " and " << j;
}

TEST(Fill, StaysInTheBoxAndOffTheWalls) {
  const Case setup = with_fills().read();
  for (const BodySpec& body : bodies_of(setup)) {
    const auto box = rigid::bounding_box(setup.shapes[body.shape], body.pose);
    EXPECT_GE(box.lower[2], (body.kind == 2 ? 18 : body.kind == 1 ? 0.5 : 0) - 1e-9);
    EXPECT_LE(box.upper[2], (body.kind == 1 ? 31.5 : 32) + 1e-9);
    const Vec3 centre = body.pose.to_world(rigid::mass_properties(setup.shapes[body.shape]).centre);
    for (int d = 0; d < 2; ++d) {  // periodic: canonical
      EXPECT_GE(centre[d], -1e-9);
      EXPECT_LE(centre[d], 32 + 1e-9);
    }
  }
}

/// Stars of many sizes: `diameter` says which.
Case with_sizes(const std::string& diameter, int count = 200) {
  CaseText c = with_fills();
  c.domain = domain_of({64, 64, 64});
  c.bodies = fill_of("star", 2, count, "diameter = { " + diameter + " }");
  return c.read();
}

/// Bodies of a diameter up to d, over all.
double share_up_to(double d, const Case& setup) {
  const auto bodies = bodies_of(setup);
  return static_cast<double>(std::count_if(
             bodies.begin(), bodies.end(),
             [&](const BodySpec& body) { return sphere_of_volume(setup.shapes[body.shape]) < d; })) /
         static_cast<double>(bodies.size());
}

TEST(Fill, SizesFollowTheirDistributionToABody) {
  constexpr double one = 1. / 200 + 1e-9;
  const auto border = [](int strip) { return 2 * std::pow(4., strip / 32.); };  // of 32 from 2 to 8
  const Case uniform = with_sizes("smallest = 2, largest = 8"),
             mass = with_sizes(R"(by = "mass", smallest = 2, largest = 8)");
  for (const int strip : {3, 8, 16, 24, 31}) {
    const double d = border(strip);
    EXPECT_NEAR(share_up_to(d, uniform), (d - 2) / 6, one) << d;
    // number = mass / d^3
    EXPECT_NEAR(share_up_to(d, mass), (1. / 4 - 1 / (d * d)) / (1. / 4 - 1. / 64), one) << d;
  }
  double volume = 0;
  for (const BodySpec& body : bodies_of(uniform))
    volume += rigid::mass_properties(uniform.shapes[body.shape]).volume / 200;
  const double cubes = (std::pow(8, 4) - std::pow(2, 4)) / 24;
  EXPECT_NEAR(volume, std::numbers::pi / 6 * cubes, 0.01 * volume);
  EXPECT_NEAR(mean_volume(uniform, uniform.fills[0]), std::numbers::pi / 6 * cubes, 1e-6 * volume);
}

TEST(Fill, SizesOfATableAreThoseAndDoNotOverlap) {
  for (const char* by : {"number", "mass"}) {
    const Case setup = with_sizes(std::string(R"(table = [[3, 0.8], [6, 0.8]], by = ")") + by + '"', 90);
    const double small = by == std::string("mass") ? 80 : 45;
    EXPECT_NEAR(share_up_to(5, setup) * 90, small, 1 + 1e-9);
    const auto bodies = bodies_of(setup);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      EXPECT_EQ(bodies[i].kind, bodies[0].kind);
      const double d = sphere_of_volume(setup.shapes[bodies[i].shape]);
      EXPECT_NEAR(std::min(std::abs(d - 3), std::abs(d - 6)), 0, 1e-12);
      for (std::size_t j = 0; j < i; ++j)
        EXPECT_LE(overlap_depth(setup.shapes[bodies[i].shape], bodies[i].pose, setup.shapes[bodies[j].shape],
                                bodies[j].pose, extent_of(setup)),
                  1e-9);
    }
  }
}

/// One body at a time: all sizes come, as often as they should.
TEST(Fill, SizesOfManySmallApplicationsFollowTheDistributionToo) {
  const Case setup = with_sizes(R"(table = [[3, 0.25], [6, 0.75]])", 1);
  int small = 0;
  constexpr int times = 4000;
  for (int number = 1; number <= times; ++number) {
    const std::int64_t of_small = FillApplication(0, number, 0).count(setup.fills[0]);
    EXPECT_EQ(of_small + FillApplication(0, number, 1).count(setup.fills[0]), 1);
    small += static_cast<int>(of_small);
  }
  EXPECT_NEAR(small, times / 4, 4 * std::sqrt(times * 3. / 16));
}

TEST(Fill, AlignedBodiesAreNotTurned) {
  for (const BodySpec& body : bodies_of(with_fills().read({"fill[0].orientation=aligned"})))
    EXPECT_TRUE(body.kind != 1 || body.pose.orientation.w() == 1);
}

TEST(Fill, OrientationsAreUniform) {
  CaseText c = with_fills();
  c.bodies = "[[fill]]\nshape = \"ball\"\ndensity = 1\ncount = 4000\n";
  const auto bodies = bodies_of(c.read({"domain.size=[320, 320, 320]"}));
  Vec3 mean = Vec3::Zero();
  rigid::Mat3 second = rigid::Mat3::Zero();
  for (const BodySpec& body : bodies) {
    const Vec3 axis = body.pose.orientation * Vec3::UnitX();
    mean += axis / bodies.size();
    second += axis * axis.transpose() / bodies.size();
  }
  EXPECT_LT(mean.norm(), 0.05);
  EXPECT_LT((second - rigid::Mat3::Identity() / 3).norm(), 0.05);
}

/// With their gaps within the tube, given bodies or not.
TEST(Fill, StaysInATube) {
  CaseText c = with_fills();
  c.rest = "[[walls]]\ntype = \"tube\"\naxis = [1, 0, 0]\nradius = 14\npoint = [0, 16, 15.5]\n";
  c.domain = domain_of({32, 32, 32}, R"("no-slip")");
  const Case setup = c.read({"fill[0].count=12", "fill[1].count=3"});
  const auto bodies = bodies_of(setup);
  ASSERT_EQ(bodies.size(), 16u);
  for (const BodySpec& body : bodies)
    EXPECT_GE(rigid::gap_in_tube(setup.shapes[body.shape], body.pose, rigid::Tube{14},
                                 setup.walls[0].tube()->pose()),
              0);
}

// ---- the statistics of random sequential addition ----

constexpr int realisations = 40;
constexpr double edge = 48, radius = 3;  // of a periodic box, and of the balls in it
constexpr int balls = 160;               // 16 % of the volume

/// The counts of a realisation: pairs in shells from touching to twice that, bodies in eighths of the box.
constexpr int shells = 12;
using Counts = std::array<double, shells>;

Counts pair_counts(const std::vector<Vec3>& centres) {
  Counts counts{};
  for (std::size_t i = 0; i < centres.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      Vec3 d = centres[i] - centres[j];
      for (int k = 0; k < 3; ++k) d[k] -= edge * std::round(d[k] / edge);
      const int shell = static_cast<int>((d.norm() / (2 * radius) - 1) * shells);
      if (shell < shells) counts[shell] += 1;
    }
  return counts;
}

/// Places bodies by the definition: uniform places one after the other, taken if they are free.
std::vector<Vec3> added_one_by_one(unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> place(0, edge);
  std::vector<Vec3> centres;
  while (centres.size() < balls) {
    const Vec3 x(place(engine), place(engine), place(engine));
    const bool free = std::all_of(centres.begin(), centres.end(), [&](const Vec3& y) {
      Vec3 d = x - y;
      for (int k = 0; k < 3; ++k) d[k] -= edge * std::round(d[k] / edge);
      return d.norm() >= 2 * radius;
    });
    if (free) centres.push_back(x);
  }
  return centres;
}

std::vector<Vec3> filled(unsigned seed, int count, double ball) {
  CaseText c;
  c.domain = domain_of({48, 48, 48});
  c.fluid = "";
  c.shapes = sphere_of("ball", 2 * ball);
  c.bodies = fill_of("ball", 1, count, "seed = " + std::to_string(seed));
  std::vector<Vec3> centres;
  for (const BodySpec& body : bodies_of(c.read())) centres.push_back(body.pose.position);
  return centres;
}

struct Statistics {
  Counts sum{}, squares{};
  void add(const Counts& counts) {
    for (int k = 0; k < shells; ++k) sum[k] += counts[k], squares[k] += counts[k] * counts[k];
  }
  double mean(int k) const { return sum[k] / realisations; }
  double variance_of_mean(int k) const {
    return (squares[k] / realisations - mean(k) * mean(k)) / realisations;
  }
};

TEST(Fill, PairsAreAsFarApartAsInRandomSequentialAddition) {
  Statistics ours, theirs;
  for (int seed = 0; seed < realisations; ++seed) {
    ours.add(pair_counts(filled(seed, balls, radius)));
    theirs.add(pair_counts(added_one_by_one(seed)));
  }
  double chi_squared = 0;
  for (int k = 0; k < shells; ++k)
    chi_squared +=
        std::pow(ours.mean(k) - theirs.mean(k), 2) / (ours.variance_of_mean(k) + theirs.variance_of_mean(k));
  EXPECT_LT(chi_squared, 33) << "the probability of more is 1e-3";
  EXPECT_GT(ours.mean(0), 1.2 * ours.mean(shells - 1) / 3.4) << "they crowd where they touch";
}

/// If bodies are next to nothing, their number in an eighth of the box is binomial: neither more even nor
/// less.
TEST(Fill, DensityFluctuatesAsThatOfIndependentPoints) {
  constexpr int count = 400;
  double sum = 0, squares = 0;
  for (int seed = 0; seed < realisations; ++seed) {
    std::array<double, 8> eighths{};
    for (const Vec3& x : filled(seed, count, 0.01))
      eighths[(x[0] < edge / 2) + 2 * (x[1] < edge / 2) + 4 * (x[2] < edge / 2)] += 1;
    for (const double n : eighths) sum += n, squares += n * n;
  }
  const double mean = sum / (8 * realisations), variance = squares / (8 * realisations) - mean * mean;
  EXPECT_DOUBLE_EQ(mean, count / 8.0);
  EXPECT_NEAR(variance / (count / 8.0 * 7 / 8), 1, 0.25);
}

/// Random places leave room for at most 38 % of a large box.
TEST(Fill, ReachesThirtyFourPerCent) {
  EXPECT_EQ(filled(1, 332, radius).size(), 332u);
}

}  // namespace
}  // namespace silt::testing

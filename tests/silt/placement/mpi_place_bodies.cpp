// The bodies of a case on any number of ranks and for any blocks: the same to the bit, each on the rank that
// has its centre; what cannot be placed, and given bodies that are where they must not be, every rank says
// alike.
#include <gtest/gtest.h>

#include <bit>
#include <random>
#include <set>

#include "coupler/spec/counter_random.hpp"
#include "parallel/collectives.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/placement/given_bodies.hpp"
#include "silt/placement/place_bodies.hpp"
#include "tests/errors.hpp"
#include "tests/silt/placement/placed.hpp"
#include "tests/world.hpp"

namespace silt::testing {
namespace {

using namespace coupler;

using rigid::BodyId;
using rigid::Vec3;
using tests::alone;
using tests::rank;
using tests::ranks;

std::uint64_t hash_of(BodyId id, const BodySpec& body) {
  std::uint64_t h = mixed(id);
  const auto add = [&](double x) { h = mixed(h + std::bit_cast<std::uint64_t>(x)); };
  for (int d = 0; d < 3; ++d) add(body.pose.position[d]);
  for (int k = 0; k < 4; ++k) add(body.pose.orientation.coeffs()[k]);
  add(body.kind), add(body.shape), add(body.density);
  return h;
}

/// Returns a hash of all bodies; each must be on the rank that has its centre.
std::uint64_t placed_hash(const Case& setup, MPI_Comm comm) {
  std::uint64_t sum = 0;
  int here = 0, n = 1;
  MPI_Comm_rank(comm, &here);
  MPI_Comm_size(comm, &n);
  const lbm::Domain domain = make_domain(setup, n);
  const Holders holders(domain, 0);
  place_bodies(setup, domain, comm).for_each([&](BodyId id, const BodySpec& body) {
    const Vec3 centre = rigid::mass_properties(setup.shapes[body.shape]).centre;
    EXPECT_EQ(holders.rank_at(body.pose.to_world(centre)), here) << "body " << id;
    sum += hash_of(id, body);
  });
  parallel::sum_over_ranks(comm, std::span(&sum, 1));
  return sum;
}

/// A communicator of the first ranks of the world; MPI_COMM_NULL on the others.
MPI_Comm first_ranks(int n) {
  MPI_Comm comm;
  MPI_Comm_split(MPI_COMM_WORLD, rank() < n ? 0 : MPI_UNDEFINED, rank(), &comm);
  return comm;
}

void expect_the_same(const CaseText& text, const Overrides& overrides = {}) {
  const std::uint64_t expected = alone([&] { return placed_hash(text.read(overrides), MPI_COMM_SELF); });
  for (const char* blocks : {"\"auto\"", "[8, 32, 5]", "[3, 7, 32]", "[2, 32, 16]"})
    for (const int n :
         std::set{1, 2, std::min(3, ranks()), std::min(5, ranks()), std::min(7, ranks()), ranks()}) {
      if (n > ranks()) continue;
      MPI_Comm comm = first_ranks(n);
      if (comm == MPI_COMM_NULL) continue;
      Overrides all = overrides;
      all.push_back(std::string("domain.blocks=") + blocks);
      EXPECT_EQ(placed_hash(text.read(all), comm), expected) << n << " ranks, blocks " << blocks;
      MPI_Comm_free(&comm);
    }
}

TEST(PlaceBodies, TheSameOnAnyRanksAndBlocks) {
  expect_the_same(with_fills());
}

TEST(PlaceBodies, TheSameOfManySizes) {
  CaseText c = with_fills();
  c.bodies = fill_of("star", 2, 60, R"(diameter = { smallest = 1, largest = 6 })");
  expect_the_same(c);
}

TEST(PlaceBodies, TheSamePeriodicAllRoundAndDense) {
  CaseText c = with_fills();
  c.domain = domain_of({32, 32, 32});
  c.shapes = sphere_of("ball", 4);
  c.bodies =
      fill_of("ball", 2, 240, "seed = 7") + fill_of("ball", 2, 6, "seed = 7\nbox = [[0, 0, 0], [32, 9, 32]]");
  expect_the_same(c);
}

TEST(PlaceBodies, TheSameInATube) {
  CaseText c = with_fills();
  c.rest = "[[walls]]\ntype = \"tube\"\naxis = [1, 0, 0]\nradius = 14\npoint = [0, 16, 15.5]\n";
  c.domain = domain_of({32, 32, 32}, "\"no-slip\"");
  expect_the_same(c, {"fill[0].count=12", "fill[1].count=3"});
}

/// Sites that are taken by what is there are left out, as a second fill between those of the first.
TEST(PlaceBodies, TheSameOnSites) {
  CaseText c;
  c.shapes = sphere_of("ball", 4) + sphere_of("dot", 1);
  for (const char* arrangement : {"simple-cubic", "hexagonal"}) {
    const std::string lines = std::string("arrangement = \"") + arrangement + "\"\nshift = 0.2\n";
    const std::string fill = "[[fill]]\ndensity = 2\n" + lines;
    c.bodies = body_of("ball", 1, "position = [16, 16, 16]") + fill + "shape = \"ball\"\ncount = 50\n" +
               fill + "shape = \"dot\"\n" + fill_of("dot", 3, 30, "");
    expect_the_same(c);
  }
}

TEST(PlaceBodies, IdsCountFromOne) {
  const Case setup = with_fills().read();
  std::uint64_t sums[2] = {0, 0};
  std::set<BodyId> ids;
  place(setup, MPI_COMM_WORLD).for_each([&](BodyId id, const BodySpec& body) {
    EXPECT_EQ(body.kind, id == 1 ? 0 : id <= 41 ? 1 : 2);
    EXPECT_TRUE(ids.empty() || id > *ids.rbegin());
    ids.insert(id);
  });
  for (const BodyId id : ids) sums[0] += 1, sums[1] += id;
  parallel::sum_over_ranks(MPI_COMM_WORLD, std::span(sums));
  EXPECT_EQ(sums[0], 45u);
  EXPECT_EQ(sums[1], 45u * 46 / 2);
}

TEST(PlaceBodies, WhatDoesNotFitEveryRankSaysAlike) {
  const CaseText c = with_fills();
  const Overrides crowded = {"fill[0].count=200"};
  const std::string text = fault_of(c.read(crowded), MPI_COMM_WORLD);
  EXPECT_EQ(text, fault_of(c.read(crowded)));
  EXPECT_TEXT(text, "fill[0].count is 200, but only ");
}

TEST(PlaceBodies, GivenBodiesThatOverlapAreNamedOnEveryRank) {
  CaseText c;
  c.domain = domain_of({32, 32, 32});
  c.bodies =
      body_of("ball", 1, "positions = [[15, 4, 4], [15, 16, 28], [15, 16, 3], [17, 5, 4], [4, 20, 16]]");
  const std::string text = fault_of(c.read(), MPI_COMM_WORLD);
  EXPECT_EQ(text, fault_of(c.read()));
  const std::string key = "bodies[0].positions: the body at ";
  EXPECT_TEXT(text,
              key + "[15, 16, 3] overlaps the one at [15, 16, 28] (entry 0) by at least 1 at the start");
  EXPECT_TEXT(text, key + "[17, 5, 4] overlaps the one at [15, 4, 4] (entry 0) by at least 5.76393");
}

TEST(PlaceBodies, GivenBodiesOutsideOrInWallsAreNamedOnEveryRank) {
  CaseText c;
  c.bodies = body_of("ball", 1, "position = [33, 4, 4]") + body_of("ball", 1, "position = [30, 30, 30]");
  const std::string text = fault_of(c.read(), MPI_COMM_WORLD);
  EXPECT_EQ(text, fault_of(c.read()));
  EXPECT_TEXT(text, "bodies[0].position is [33, 4, 4]; it must lie in the domain");
  EXPECT_TEXT(text, "bodies[1].position is [30, 30, 30]: the body reaches 2 into the upper wall of z");
}

/// If there are more than ten faults, the first ten are told, whoever finds them.
TEST(PlaceBodies, OnlyTheFirstFaultsAreTold) {
  CaseText c;
  std::string positions;
  for (int i = 0; i < 30; ++i) positions += (i ? ", [" : "[") + std::to_string(31 - i) + ", 16, 29]";
  c.bodies = body_of("ball", 1, "positions = [" + positions + "]");
  const auto all = judgement(c.read(), MPI_COMM_WORLD);
  ASSERT_EQ(all.size(), 10u);
  for (int i = 0; i < 10; ++i) EXPECT_TEXT(all[i].text, "is [" + std::to_string(31 - i) + ", 16, 29]");
}

TEST(NumberOff, CountsSmallerKeysOfAllRanks) {
  constexpr std::uint64_t range = std::uint64_t{1} << 40;
  std::mt19937_64 engine(5);  // the same keys on every rank, dealt out
  std::set<std::uint64_t> keys;
  while (keys.size() < 1000) keys.insert(engine() % range);
  std::vector<std::uint64_t> mine, expected;
  std::uint64_t place = 0;
  for (const std::uint64_t key : keys) {
    if (static_cast<int>(mixed(key) % ranks()) == rank()) mine.push_back(key), expected.push_back(place);
    ++place;
  }
  parallel::Messages messages(MPI_COMM_WORLD);
  EXPECT_EQ(number_off(messages, mine, range), expected);
}

}  // namespace
}  // namespace silt::testing

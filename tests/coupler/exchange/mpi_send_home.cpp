// Bodies saved on any ranks come to their owners, each once and with all it has.
#include "coupler/exchange/parallel_body_exchange.hpp"

#include <gtest/gtest.h>

#include "tests/coupler/exchange/exchange_scene.hpp"
#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

using tests::rank;
using tests::ranks;

/// Returns as many impulses as the id says, unlike any other body's.
std::vector<rigid::StoredImpulse> impulses(BodyId id) {
  std::vector<rigid::StoredImpulse> list;
  for (BodyId k = 0; k < id % 4; ++k)
    list.push_back(
        {id + k + 1, {std::int8_t(k % 3 - 1), 1, 0}, id << 8 | k, Vec3(0.1 * double(id), -0.0, k)});
  return list;
}

/// All bodies of a scene, with impulses, as one rank alone has them.
rigid::BodySet with_impulses(const ExchangeScene& scene) {
  rigid::BodySet bodies = scene.bodies;
  for (std::size_t row = 0; row < bodies.owned; ++row) bodies.stored_impulses[row] = impulses(bodies.id[row]);
  return bodies;
}

/// Saves every body of the scene on the rank that a rule names, and sends all home.
template <class Rule>
rigid::BodySet sent(const ExchangeScene& scene, const Holders& holders, std::size_t at_once,
                    Rule&& saved_on) {
  const rigid::BodySet all = with_impulses(scene);
  SavedBodies saved;
  for (std::size_t row = 0; row < all.owned; ++row)
    if (saved_on(row) == rank()) {
      saved.records.push_back(all.record(row));
      saved.impulses.push_back(all.stored_impulses[row]);
    }
  rigid::BodySet here;
  parallel::Messages messages(MPI_COMM_WORLD);
  distribute_to_owners(messages, holders, saved, here, at_once);
  return here;
}

TEST(SendHome, every_body_comes_whole_to_the_rank_of_its_centre) {
  const ExchangeScene scene = gas(1);
  const lbm::Domain domain(scene.cells, scene.sides(), {}, ranks());
  const Holders holders(domain, 0);
  const std::uint64_t expected = records_hash(MPI_COMM_SELF, with_impulses(scene));
  const std::size_t n = scene.bodies.owned;
  for (const std::size_t at_once : {std::size_t{5}, n, std::size_t{1} << 14})
    for (const int deal : {0, 1, 2}) {
      const auto here = sent(scene, holders, at_once, [&](std::size_t row) {
        return deal == 0 ? int(row % ranks()) : deal == 1 ? int(row * ranks() / n) : ranks() - 1;
      });
      EXPECT_EQ(count_owned(MPI_COMM_WORLD, here), count_owned(MPI_COMM_SELF, scene.bodies));
      EXPECT_EQ(records_hash(MPI_COMM_WORLD, here), expected) << "deal " << deal << ", at once " << at_once;
      for (std::size_t row = 0; row < here.owned; ++row) {
        EXPECT_EQ(holders.rank_at(here.position[row]), rank());
        EXPECT_TRUE(row == 0 || here.id[row - 1] < here.id[row]);
        EXPECT_EQ(here.row_of(here.id[row]), row);
      }
    }
}

TEST(SendHome, no_bodies_at_all) {
  const ExchangeScene scene(1, 0);
  const lbm::Domain domain(scene.cells, scene.sides(), {}, ranks());
  const auto here = sent(scene, Holders(domain, 0), 1, [](std::size_t) { return 0; });
  EXPECT_EQ(here.size(), 0u);
}

}  // namespace
}  // namespace silt::coupler::testing

// What the check of the exchange finds: deliberate mistakes in the bodies of one rank, and what the error
// says.
#include <gtest/gtest.h>

#include "tests/coupler/exchange/exchange_scene.hpp"
#include "tests/world.hpp"

namespace silt::coupler {
namespace {

using namespace testing;
using tests::rank;

void expect_text(const std::string& whole, const std::string& part) {
  EXPECT_NE(whole.find(part), std::string::npos) << "\"" << part << "\" is not in \"" << whole << '"';
}

/// The text of the error on this rank; none: "".
std::string error_of(SceneRun<>& run, const ExpectedBodies& expected) {
  CheckUnderWay check;
  check.start(run.exchange, run.bodies(), expected, 300);
  try {
    check.finish(run.exchange, run.bodies(), expected);
  } catch (const std::logic_error& error) {
    return error.what();
  }
  return "";
}

/// On the first rank that has a copy: its number there, and the copy's place; on others nobody.
int first_rank_with_a_copy(const rigid::BodySet& bodies) {
  int first = bodies.copies > 0 ? rank() : ranks_of(MPI_COMM_WORLD);
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
  return first;
}

std::uint64_t told_by(int speaker, std::uint64_t x) {
  MPI_Bcast(&x, 1, MPI_UINT64_T, speaker, MPI_COMM_WORLD);
  return x;
}

TEST(CheckExchange, SoundBodiesPass) {
  SceneRun<> run(MPI_COMM_WORLD, gas(1));
  const ExpectedBodies all(run.bodies());
  for (int i = 0; i < 20; ++i) run.advance();
  EXPECT_EQ(error_of(run, all), "");
}

TEST(CheckExchange, FindsACopyThatDiffersByOneBit) {
  if (ranks_of(MPI_COMM_WORLD) == 1) return;
  SceneRun<> run(MPI_COMM_WORLD, gas(1));
  const ExpectedBodies all(run.bodies());
  run.advance();
  rigid::BodySet& bodies = run.bodies();
  const int at = first_rank_with_a_copy(bodies);
  std::uint64_t id = 0, owner = 0;
  if (rank() == at) {
    const std::size_t row = bodies.owned;
    id = bodies.id[row];
    owner = run.exchange.owner_of(bodies, row);
    double& spin = bodies.angular_velocity[row][1];
    spin = std::bit_cast<double>(std::bit_cast<std::uint64_t>(spin) ^ 1);
  }
  id = told_by(at, id);
  owner = told_by(at, owner);
  const std::string error = error_of(run, all);
  expect_text(error, "step 300: body " + std::to_string(id) + " differs on rank " + std::to_string(at));
  expect_text(error, "from rank " + std::to_string(owner) + ", which owns it");
}

TEST(CheckExchange, FindsABodyWithoutAnOwner) {
  SceneRun<> run(MPI_COMM_WORLD, gas(1));
  const ExpectedBodies all(run.bodies());
  run.advance();
  rigid::BodySet& bodies = run.bodies();
  const int at = first_rank_with_a_copy(bodies);
  const bool copied = at < ranks_of(MPI_COMM_WORLD);
  std::uint64_t id = bodies.id[0], owner = 0;
  if (copied && rank() == at) {
    id = bodies.id[bodies.owned];
    owner = run.exchange.owner_of(bodies, bodies.owned);
  }
  id = told_by(copied ? at : 0, id);
  owner = told_by(copied ? at : 0, owner);
  if (rank() == static_cast<int>(owner)) {
    bodies.erase(bodies.row_of(id));
    --bodies.owned;
    bodies.reindex();
  }
  const std::string error = error_of(run, all);
  if (!copied) {
    expect_text(error, "step 300: 63 bodies have an owner, not 64");
    return;
  }
  expect_text(
      error, "step 300: body " + std::to_string(id) + " is owned by no rank, but rank " + std::to_string(at));
  expect_text(error, "takes rank " + std::to_string(owner) + " for its owner");
}

TEST(CheckExchange, FindsABodyThatLeftNoTrace) {
  ExchangeScene scene(1, 0);
  const int ball = scene.shape(rigid::Sphere{0.4});
  for (int id = 1; id <= 5; ++id) scene.add(id, ball, {2.0 + 4 * id, 2, 2}, Vec3::Zero());
  SceneRun<> run(MPI_COMM_WORLD, scene, "sffd", {}, 0.5);
  const ExpectedBodies all(run.bodies());
  rigid::BodySet& bodies = run.bodies();
  if (const std::size_t row = bodies.row_of(3); row < bodies.size()) {
    (row < bodies.owned ? bodies.owned : bodies.copies) -= 1;
    bodies.erase(row);
    bodies.reindex();
  }
  expect_text(error_of(run, all), "step 300: body 3 is owned by no rank;");
}

TEST(CheckExchange, FindsABodyWithTwoOwners) {
  if (ranks_of(MPI_COMM_WORLD) == 1) return;
  SceneRun<> run(MPI_COMM_WORLD, gas(1));
  const ExpectedBodies all(run.bodies());
  rigid::BodySet& bodies = run.bodies();
  const std::uint64_t id = told_by(0, bodies.id[0]);
  if (rank() == 1) {
    rigid::BodyRecord record;
    record.id = id;
    if (const std::size_t row = bodies.row_of(id); row < bodies.size()) {
      record = bodies.record(row);
      bodies.erase(row);
      --bodies.copies;
    }
    bodies.add(record);
    bodies.reindex();
  }
  expect_text(error_of(run, all), "step 300: body " + std::to_string(id) + " is owned by ranks 0 and 1");
}

}  // namespace
}  // namespace silt::coupler

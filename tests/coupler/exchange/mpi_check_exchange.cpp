// Mistakes that the check of the exchange finds, and that show in the hash of the state: deliberate mistakes
// in the bodies of one rank, in the rule of the exchange, and in the last bit of a contact's normal.
#include <gtest/gtest.h>

#include "tests/coupler/exchange/exchange_scene.hpp"
#include "tests/errors.hpp"
#include "tests/world.hpp"

namespace silt::coupler {
namespace {

using namespace testing;
using tests::rank;

/// The text of the error on this rank; none: "".
std::string error_of(SceneRun<>& run, const ExpectedBodies& expected) {
  PendingCheck check;
  check.start(run.exchange, run.bodies(), expected, 300);
  return tests::error_of<std::logic_error>([&] { check.finish(run.exchange, run.bodies(), expected); });
}

/// Returns the first rank that has a copy, or the number of ranks if none has.
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
  EXPECT_TEXT(error, "step 300: body " + std::to_string(id) + " differs on rank " + std::to_string(at));
  EXPECT_TEXT(error, "from rank " + std::to_string(owner) + ", which owns it");
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
    EXPECT_TEXT(error, "step 300: 63 bodies have an owner, not 64");
    return;
  }
  EXPECT_TEXT(
      error, "step 300: body " + std::to_string(id) + " is owned by no rank, but rank " + std::to_string(at));
  EXPECT_TEXT(error, "takes rank " + std::to_string(owner) + " for its owner");
}

TEST(CouplingState, HasALineForEveryMember) {
  std::size_t bytes = 0;
  visit_columns(CouplingState{}, [&](const CouplingColumn&, auto numbers) { bytes += numbers.size_bytes(); });
  EXPECT_EQ(bytes, sizeof(CouplingState));
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
  EXPECT_TEXT(error_of(run, all), "step 300: body 3 is owned by no rank;");
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
  EXPECT_TEXT(error_of(run, all), "step 300: body " + std::to_string(id) + " is owned by ranks 0 and 1");
}

enum class Rule { right, nobody_makes_contacts, whoever_finds_them };

class MistakenExchange : public ParallelBodyExchange {
 public:
  using ParallelBodyExchange::ParallelBodyExchange;
  Rule rule = Rule::right;
  mutable int mistakes = 0;

  bool owns_contact_at(const Vec3& x_W) const override {
    const bool right = ParallelBodyExchange::owns_contact_at(x_W);
    const bool answer = rule == Rule::right ? right : rule == Rule::whoever_finds_them;
    mistakes += answer != right;
    return answer;
  }
};

class OffByABit : public rigid::CollisionBackend {
 public:
  bool wrong = false;
  std::string_view name() const override { return "off by a bit"; }
  void collide(const rigid::ConvexShape& a, const rigid::Pose& pose_a, const rigid::ConvexShape& b,
               const rigid::Pose& pose_b, double tolerance, std::vector<rigid::ContactPoint>& out) override {
    const std::size_t first = out.size();
    right_->collide(a, pose_a, b, pose_b, tolerance, out);
    for (std::size_t k = first; wrong && k < out.size(); ++k) out[k].normal *= std::nextafter(1.0, 0.0);
  }

 private:
  std::unique_ptr<rigid::CollisionBackend> right_ = adapters::make_backend("auto");
};

/// The hash after 60 steps, of which ten in the middle follow the rule and the backend given.
std::uint64_t hash_with(Rule rule, bool off_by_a_bit) {
  auto backend = std::make_unique<OffByABit>();
  OffByABit& patched = *backend;
  SceneRun<MistakenExchange> run(MPI_COMM_WORLD, gas(0.5), "sffd", {}, contact_rim, std::move(backend));
  for (int i = 0; i < 60; ++i) {
    const bool in_the_middle = i >= 20 && i < 30;
    run.exchange.rule = in_the_middle ? rule : Rule::right;
    patched.wrong = in_the_middle && off_by_a_bit;
    run.advance();
  }
  const bool possible = rule == Rule::nobody_makes_contacts ||
                        (rule == Rule::whoever_finds_them && ranks_of(MPI_COMM_WORLD) > 1);
  EXPECT_EQ(sum_of(MPI_COMM_WORLD, run.exchange.mistakes) > 0, possible);
  return run.hash();
}

TEST(ExchangeMistakes, ShowInTheHash) {
  const std::uint64_t right = hash_with(Rule::right, false);
  EXPECT_EQ(hash_with(Rule::right, false), right);
  EXPECT_NE(hash_with(Rule::nobody_makes_contacts, false), right);
  EXPECT_NE(hash_with(Rule::right, true), right);
  if (ranks_of(MPI_COMM_WORLD) == 1) return;
  EXPECT_NE(hash_with(Rule::whoever_finds_them, false), right);
}

}  // namespace
}  // namespace silt::coupler

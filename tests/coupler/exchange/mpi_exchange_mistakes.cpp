// Mistakes built into the code show in the hash of the state: of the rule by which the exchange says which
// rank makes a contact, and of the last bit of a contact's normal.
#include <gtest/gtest.h>

#include "tests/coupler/exchange/exchange_scene.hpp"

namespace silt::coupler {
namespace {

using namespace testing;

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

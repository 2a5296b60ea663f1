// A backend is chosen by its name, and the answer of its engine is checked.
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "adapters/automatic/collision_factory.hpp"
#include "adapters/common/engine_backend.hpp"
#include "rigid/collision/manifold.hpp"
#include "tests/adapters/collision_scenes.hpp"
#include "tests/errors.hpp"

namespace silt::tests {
namespace {

using adapters::Answer;
using adapters::Query;

/// Says the same of every pair.
class Parrot : public adapters::EngineBackend {
 public:
  explicit Parrot(std::optional<Answer> answer) : answer_(answer) {}
  std::string_view name() const override { return "parrot"; }

 protected:
  int methods(const Query&) const override { return 2; }
  std::optional<Answer> ask(int, const Query&) override { return answer_; }
  std::unique_ptr<adapters::MeshTree> make_tree(const rigid::SharedMesh&) override { return nullptr; }

 private:
  std::optional<Answer> answer_;
};

/// Two boxes, faces `gap` apart along z; b is off to the side.
Pair boxes(double gap) {
  return stacked_boxes({2, 1, 2}, {0.3, 0.2, 0}, 17, gap);
}

void expect_replaced(const Pair& p, std::optional<Answer> wrong, unsigned fallbacks) {
  Parrot parrot(wrong);
  const Points points = collide(parrot, p), right = collide(*adapters::make_backend("analytic"), p);
  EXPECT_EQ(parrot.counters().fallbacks, fallbacks);
  ASSERT_EQ(points.size(), right.size());
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(points[i].gap, right[i].gap, 1e-12);
}

TEST(EngineAnswers, TheRightOneIsTaken) {
  expect_replaced(boxes(0.2), Answer{Vec3::UnitZ(), 0.2}, 0);
  expect_replaced(boxes(-0.2), Answer{Vec3::UnitZ(), -0.2}, 0);
}

TEST(EngineAnswers, AWrongGapIsReplaced) {
  expect_replaced(boxes(0.2), Answer{Vec3::UnitZ(), 0.2 + 1e-6}, 2);
  expect_replaced(boxes(0.2), Answer{Vec3::UnitZ(), -1}, 2);
  expect_replaced(boxes(-0.2), Answer{Vec3::UnitZ(), -0.2 - 1e-6}, 2);
}

TEST(EngineAnswers, AWrongNormalIsReplaced) {
  expect_replaced(boxes(0.2), Answer{-Vec3::UnitZ(), 0.2}, 2);
  expect_replaced(boxes(-0.2), Answer{Vec3(0.01, 0, 1).normalized(), -0.2}, 2);
  expect_replaced(boxes(0.2), Answer{Vec3::Zero(), 0.2}, 2);
  expect_replaced(boxes(0.2), Answer{Vec3::Constant(std::nan("")), 0.2}, 2);
}

TEST(EngineAnswers, AConsistentOverlapThatIsDeeperThanNeededIsReplaced) {
  const Pair p = boxes(-0.2);
  expect_replaced(p, Answer{Vec3::UnitX(), support_gap(p, Vec3::UnitX())}, 2);
}

TEST(EngineAnswers, NoContactIsReplacedWhereThereIsOneAndBelievedWhereNot) {
  expect_replaced(boxes(0.2), std::nullopt, 2);
  expect_replaced(boxes(-0.2), std::nullopt, 2);
  expect_replaced(boxes(1.5), std::nullopt, 0);
}

TEST(EngineAnswers, APlaneIsCheckedToo) {
  const Pair p{rigid::Sphere{2}, rigid::HalfSpace{Vec3::UnitZ()}, {Vec3(0, 0, 2.1), Quat::Identity()}, {}};
  for (const auto& [answer, fallbacks] :
       {std::pair(std::optional(Answer{-Vec3::UnitZ(), 0.1}), 0u),
        std::pair(std::optional(Answer{Vec3::UnitZ(), 0.1}), 1u),
        std::pair(std::optional(Answer{-Vec3::UnitZ(), 0.2}), 1u), std::pair(std::optional<Answer>(), 1u)}) {
    Parrot parrot(answer);
    const Points points = collide(parrot, p);
    EXPECT_EQ(parrot.counters().fallbacks, fallbacks);
    ASSERT_EQ(points.size(), 1u);
    EXPECT_NEAR(points[0].gap, 0.1, 1e-15);
  }
}

TEST(Manifold, TheDeepestPointSurvivesANormalThatIsSlightlyOff) {
  // a capsule along the edge of a box, outside of both its faces: seen along a normal that is off it lies
  // beside the face
  const rigid::Capsule capsule{2, 3};
  const rigid::Box box{{4, 3, 2}};
  const Vec3 right = Vec3(1, 0, 1).normalized();
  const Pose above{Vec3(4, 0, 2) + 2.1 * right, turned(90, Vec3::UnitX())};
  const rigid::ConvexShape shape_a = box, shape_b = capsule;
  const auto a = rigid::convex_core(shape_a, {}), b = rigid::convex_core(shape_b, above);
  for (const double off : {0.0, 1e-9, -1e-9, 1e-7, -1e-7, 1e-6, -1e-6}) {
    const Vec3 n = (right + off * Vec3(1, 0, -1)).normalized();
    Points points;
    rigid::append_box_manifold(a, b, {n, rigid::box_separation(a, b, n)}, 1, points);
    ASSERT_FALSE(points.empty()) << off;
    EXPECT_NEAR(deepest(points).gap, 0.1, 1e-8) << off;
    EXPECT_LE(off_surface(box, {}, deepest(points).on_a), 1e-5) << off;
    EXPECT_LE(off_surface(capsule, above, deepest(points).on_b), 1e-5) << off;
  }
}

TEST(CollisionFactory, KnowsItsNames) {
  const auto names = adapters::backend_names();
  EXPECT_EQ(names, (std::vector<std::string_view>{"auto", "analytic", "bullet", "fcl"}));
  for (const auto name : names) EXPECT_EQ(adapters::make_backend(name)->name(), name);
}

TEST(CollisionFactory, AnUnknownNameIsRefusedWithTheKnownOnes) {
  EXPECT_EQ(tests::error_of<std::invalid_argument>([] { adapters::make_backend("bulet"); }),
            "unknown collision backend \"bulet\"; known: auto, analytic, bullet, fcl");
}

TEST(CollisionFactory, OnlyTheDoublePrecisionBulletIsLoaded) {
  std::ifstream maps("/proc/self/maps");
  bool loaded = false;
  for (std::string line; std::getline(maps, line);) {
    if (line.find("libBulletCollision") == std::string::npos &&
        line.find("libLinearMath") == std::string::npos)
      continue;
    EXPECT_TEXT(line, "-float64.so");
    loaded = true;
  }
  EXPECT_TRUE(loaded);
}

}  // namespace
}  // namespace silt::tests

// Every second belongs to one stage: a stage within another suspends it.
#include "rigid/math/stage_clock.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>
#include <thread>

namespace silt::rigid {
namespace {

enum class Stage { outer, inner, count };

double outer(const StageClock<Stage>& clock) {
  return clock.seconds()[int(Stage::outer)];
}
double inner(const StageClock<Stage>& clock) {
  return clock.seconds()[int(Stage::inner)];
}
void rest() {
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

TEST(StageClock, CountsNoSecondTwice) {
  StageClock<Stage> clock;
  const auto begin = std::chrono::steady_clock::now();
  const int answer = clock.timed(Stage::outer, [&] {
    rest();
    clock.timed(Stage::inner, rest);
    rest();
    return 42;
  });
  const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_EQ(answer, 42);
  EXPECT_GE(outer(clock), 0.01);
  EXPECT_GE(inner(clock), 0.005);
  EXPECT_LE(outer(clock) + inner(clock), elapsed);
}

TEST(StageClock, CountsNothingBetweenStages) {
  StageClock<Stage> clock;
  clock.timed(Stage::outer, [] {});
  const double before = outer(clock);
  rest();
  clock.timed(Stage::inner, [] {});
  EXPECT_EQ(outer(clock), before);
  EXPECT_LT(inner(clock), 0.005);
}

TEST(StageClock, GoesOnFromStageToStage) {
  double read = 0;
  StageClock<Stage> clock([&] { return read; });
  {
    StageClock<Stage>::Scope stage(clock, Stage::outer);
    read += 0.25;
    stage.switch_to(Stage::inner);
    read += 1;
    rest();
    stage.switch_to(Stage::outer);
    read += 0.5;
  }
  read += 7;
  EXPECT_EQ(clock.readings()[int(Stage::outer)], 0.75);
  EXPECT_EQ(clock.readings()[int(Stage::inner)], 1);
  EXPECT_GE(inner(clock), 0.005);
}

TEST(StageClock, EndsAStageThatThrows) {
  StageClock<Stage> clock;
  EXPECT_THROW(clock.timed(Stage::outer, [] { throw std::runtime_error("stop"); }), std::runtime_error);
  const double before = outer(clock);
  rest();
  clock.timed(Stage::inner, [] {});
  EXPECT_EQ(outer(clock), before);
}

TEST(StageClock, ReadsAMeterByStage) {
  double read = 3;  // before the clock was made
  StageClock<Stage> clock([&] { return read; });
  clock.timed(Stage::outer, [&] {
    read += 0.25;
    clock.timed(Stage::inner, [&] { read += 1; });
    read += 0.5;
  });
  read += 7;  // between stages
  clock.timed(Stage::inner, [] {});
  EXPECT_EQ(clock.readings()[int(Stage::outer)], 0.75);
  EXPECT_EQ(clock.readings()[int(Stage::inner)], 1);
}

}  // namespace
}  // namespace silt::rigid

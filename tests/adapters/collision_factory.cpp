// Backends by name, and that the Bullet in the program is the one in double precision.
#include "adapters/automatic/collision_factory.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

namespace silt::tests {
namespace {

TEST(CollisionFactory, KnowsItsNames) {
  const auto names = adapters::backend_names();
  EXPECT_EQ(names, (std::vector<std::string_view>{"auto", "analytic", "bullet", "fcl"}));
  for (const auto name : names) EXPECT_EQ(adapters::make_backend(name)->name(), name);
}

TEST(CollisionFactory, AnUnknownNameIsRefusedWithTheKnownOnes) {
  try {
    adapters::make_backend("bulet");
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_STREQ(e.what(), "unknown collision backend \"bulet\"; known: auto, analytic, bullet, fcl");
  }
}

TEST(CollisionFactory, OnlyTheDoublePrecisionBulletIsLoaded) {
  std::ifstream maps("/proc/self/maps");
  bool loaded = false;
  for (std::string line; std::getline(maps, line);) {
    if (line.find("libBulletCollision") == std::string::npos &&
        line.find("libLinearMath") == std::string::npos)
      continue;
    EXPECT_NE(line.find("-float64.so"), std::string::npos) << line;
    loaded = true;
  }
  EXPECT_TRUE(loaded);
}

}  // namespace
}  // namespace silt::tests

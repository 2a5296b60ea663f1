// What a cone alone has: the line of its side.
#include "rigid/shapes/cone.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace silt::rigid {
namespace {

constexpr double radius = 0.7, height = 1.9;

/// A direction away from the cone, `degrees` from the normal of its side at +x towards the axis.
Vec3 leaning(double degrees) {
  const double angle = std::atan2(radius, height) + degrees * M_PI / 180;
  return {std::cos(angle), 0, std::sin(angle)};
}

// Up to 45 degrees from the side's normal a neighbour sees the whole line from the rim to the apex; beyond
// that the point that is furthest.
TEST(Cone, ShowsTheLineOfItsSideToNeighboursWithin45Degrees) {
  const Cone cone{radius, height};
  const Vec3 apex(0, 0, 0.75 * height);  // from the centre of mass
  for (const double degrees : {-44.0, -10.0, 0.0, 10.0, 44.0}) {
    ContactOutline outline;
    cone.facing_outline({Vec3::Zero(), Mat3::Identity()}, leaning(degrees), outline);
    ASSERT_EQ(outline.size(), 2u) << degrees;
    const Vec3 along = outline.corners[1].x - outline.corners[0].x;
    EXPECT_NEAR((outline.corners[1].x - apex).norm(), 0, 1e-14);
    EXPECT_NEAR((outline.corners[0].x - (apex + Vec3(radius, 0, -height))).norm(), 0, 1e-14);
    EXPECT_NEAR(along.norm(), std::hypot(radius, height), 1e-14);
  }
  for (const double degrees : {46.0, 60.0}) {
    ContactOutline outline;
    cone.facing_outline({Vec3::Zero(), Mat3::Identity()}, leaning(degrees), outline);
    ASSERT_EQ(outline.size(), 1u) << degrees;
    EXPECT_NEAR((outline.corners[0].x - apex).norm(), 0, 1e-14);
  }
}

}  // namespace
}  // namespace silt::rigid

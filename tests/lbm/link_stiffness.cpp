// The stiffness of a surface against its links is how their force falls with its velocity.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "lbm/cut_links.hpp"

namespace silt::lbm {
namespace {

constexpr int edge = 40;

/// A flat wall above the plane z = 3 of a block: five links from each of its inner cells, at distances that
/// differ, thousands in one group.
template <class T>
CutLinks<T> wall_links(WallScheme scheme) {
  CutLinks<T> links;
  links.frame = {{edge / 2, edge / 2, 5}, {0.21, -0.34, 0.17}, 40, true};
  for (int i = 1; i < directions; ++i)
    for (int y = 1; c[i].z == 1 && y < edge - 1; ++y)
      for (int x = 1; x < edge - 1; ++x) {
        links.place.push_back(link_place({x, y, 0}, i));
        links.q.push_back(T(0.05 + 0.9 * ((x * 7 + y * 13 + i) % 31) / 31.0));
      }
  const auto count = std::uint32_t(links.place.size());
  links.place.resize(padded(count), links.place.back()), links.q.resize(links.place.size(), links.q.back());
  links.groups.push_back({0, count, scheme, {0, 0, 3}, 0});
  return links;
}

constexpr double small = 1e-3;  // velocity, angular velocity

/// Force and torque of the links of a fluid at rest (no deviations) on a wall that moves.
template <class T>
std::array<double, 6> force_of(const CutLinks<T>& links, const SurfaceMotion& motion) {
  Block<T> block({{0, 0, 0}, {edge, edge, 8}});
  LinkSums sums;
  const LinkSlots slots = link_slots(block, Parity::settled);
  apply_cut_links<T>({block, slots, links, links.groups[0]}, motion, ForceForm::exact, sums);
  EXPECT_FALSE(sums.invalid);
  std::array<double, 6> force;
  for (int d = 0; d < 3; ++d)
    force[d] = double(sums.force[d]) * link_quantum, force[3 + d] = double(sums.torque[d]) * link_quantum;
  return force;
}

/// Each link's term of the force is off by half its quantum, that of the stiffness by two of its own.
template <class T>
void expect_slope_of_force(WallScheme scheme) {
  constexpr double rounding = link_quantum / (2 * small) + 2 * stiffness_quantum<T>;
  const CutLinks<T> links = wall_links<T>(scheme);
  const int exponent = stiffness_exponent(links.frame.reach);
  const StiffnessSums sums = stiffness_of(links, exponent);
  int e = 0;
  for (int a = 0; a < 6; ++a)
    for (int b = a; b < 6; ++b, ++e) {
      SurfaceMotion motion;
      (b < 3 ? motion.v : motion.omega)[b % 3] = small;
      const double arms = std::ldexp(1.0, exponent * ((a >= 3) + (b >= 3)));
      EXPECT_NEAR(double(sums.h[e]) * stiffness_quantum<T> * arms, -force_of(links, motion)[a] / small,
                  rounding * double(links.place.size()) * arms)
          << "row " << a << ", column " << b;
    }
}

TEST(LinkStiffness, IsHowTheForceFallsWithTheVelocity) {
  for (const WallScheme scheme :
       {WallScheme::bounce_back, WallScheme::cli, WallScheme::parabolic, WallScheme::multireflection}) {
    SCOPED_TRACE(wall_scheme_names[int(scheme)]);
    expect_slope_of_force<double>(scheme);
    expect_slope_of_force<float>(scheme);
  }
}

}  // namespace
}  // namespace silt::lbm

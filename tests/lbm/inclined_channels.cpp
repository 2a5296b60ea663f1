// Flow between plane walls at any angle to the lattice, anywhere in it, against the parabola and the straight
// line that it has.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/lbm/walled_box.hpp"

namespace silt::lbm {
namespace {

/// Walls along normal.x = first and first + width |normal|; the box has the normal's own period.
struct InclinedChannel {
  Int3 normal;
  double width, first;  // cells; in units of normal.x

  double length() const {
    return std::sqrt(double(normal.x * normal.x + normal.y * normal.y + normal.z * normal.z));
  }
  int period() const { return int(std::ceil(width * length())) + 2 * (normal.x + normal.y + normal.z); }
  /// normal.x from the first wall on.
  double across(Point p) const {
    const double s = normal.x * p.x + normal.y * p.y + normal.z * p.z - first;
    return s - period() * std::floor(s / period());
  }
  WalledScene scene() const {
    const auto cells = [&](int n) { return n ? period() : 2; };
    const InclinedChannel self = *this;
    return {{cells(normal.x), cells(normal.y), cells(normal.z)},
            [self](Point p) { return self.across(p) < self.width * self.length(); },
            [self](Point p, Int3 v) {
              const double s = self.across(p),
                           rise = self.normal.x * v.x + self.normal.y * v.y + self.normal.z * v.z;
              if (rise < 0) return Hit{s / -rise, 0};
              return rise > 0 ? Hit{(self.width * self.length() - s) / rise, 1} : Hit{2, 0};
            }};
  }
  /// A unit vector within the walls: the first or the second of two.
  std::array<double, 3> along(int which) const {
    const double l = length(), n[3] = {normal.x / l, normal.y / l, normal.z / l};
    std::array<double, 3> t =
        std::fabs(n[2]) < 0.9 ? std::array{n[1], -n[0], 0.0} : std::array{1.0, 0.0, 0.0};
    const double size = std::sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]);
    for (double& x : t) x /= size;
    if (which == 0) return t;
    return {n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0]};
  }
};

struct Drive {
  double tau = 1, magic = 1.0 / 7;
  double force = 1e-6, speed = 0;  // along the walls; of the second wall
  int along = 0;
};

/// The largest difference of a cell's velocity from the true one, over the mean of the true flow, after the
/// flow has become steady.
double velocity_error(const InclinedChannel& channel, WallScheme scheme, const Drive& drive) {
  const auto t = channel.along(drive.along);
  const double nu = (drive.tau - 0.5) / 3, width = channel.width;
  WalledBox flow(
      channel.scene(), scheme,
      {drive.tau, drive.magic, Collision::trt, {drive.force * t[0], drive.force * t[1], drive.force * t[2]}});
  for (int d = 0; d < 3; ++d) flow.motions[1].v[d] = drive.speed * t[d];
  const auto exact = [&](Point p) {
    const double z = channel.across(p) / channel.length();
    return drive.force * z * (width - z) / (2 * nu) + drive.speed * z / width;
  };
  flow.for_fluid([&](Int3 x, Point p) {
    const double u = exact(p) - drive.force / 2;  // what the force adds when it acts
    flow.fluid().set_equilibrium(0, x, 0, {u * t[0], u * t[1], u * t[2]});
  });
  for (int n = 0; n < 2000 + int(3 * width * width / nu); ++n) flow.step();
  double worst = 0;
  flow.for_fluid([&](Int3 x, Point p) {
    const auto u = flow.velocity(x);
    for (int d = 0; d < 3; ++d) worst = std::max(worst, std::fabs(u[d] - t[d] * exact(p)));
  });
  return worst / (drive.force * width * width / (12 * nu) + drive.speed / 2);
}

const Int3 normals[] = {{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {1, 2, 0}, {1, 2, 3}};

// At every angle, wall place, viscosity and magic, as long as all of the scheme is stable (equation 20).
TEST(InclinedChannels, MultireflectionHoldsTheParabolaAtAnyAngle) {
  int n = 0;
  for (const Int3 normal : normals)
    for (const int along : {0, 1}) {
      const InclinedChannel channel{normal, 4.37, 3.1 + 0.37 * ++n};
      const double tau = n % 3 == 0 ? 0.8 : n % 3 == 1 ? 1 : 2.5;
      EXPECT_LT(velocity_error(channel, WallScheme::multireflection,
                               {tau, n % 2 ? 1.0 / 7 : 1.0 / 12, 1e-9, 0, along}),
                1e-8)
          << normal.x << normal.y << normal.z << " " << along;
    }
}

// Shear between walls that slide within their planes is exact under every interpolating scheme.
TEST(InclinedChannels, ShearIsExact) {
  for (const auto scheme : {WallScheme::cli, WallScheme::parabolic, WallScheme::multireflection})
    for (const Int3 normal : {Int3{1, 1, 1}, Int3{1, 2, 0}})
      for (const double tau : {0.6, 1.2})
        EXPECT_LT(velocity_error({normal, 3.71, 4.3}, scheme, {tau, 1.0 / 7, 0, 1e-7, 1}), 1e-6)
            << wall_scheme_names[int(scheme)] << " " << tau;
}

// What the other schemes leave of the parabola falls with the square of the width; so does what
// multireflection leaves at a viscosity at which it is cli for the greater part.
TEST(InclinedChannels, OthersAreOfSecondOrder) {
  for (const auto scheme : {WallScheme::cli, WallScheme::parabolic, WallScheme::multireflection}) {
    const double tau = scheme == WallScheme::multireflection ? 0.6 : 1;
    const Drive drive{tau, best_magic(scheme, tau), 1e-7, 0, 0};
    const double coarse = velocity_error({{1, 2, 0}, 5.2, 4.3}, scheme, drive),
                 fine = velocity_error({{1, 2, 0}, 10.4, 4.3}, scheme, drive);
    printf("%s: %.3f %% of the mean at 5 cells, %.3f %% at 10\n",
           std::string(wall_scheme_names[int(scheme)]).c_str(), 100 * coarse, 100 * fine);
    EXPECT_GT(coarse, 1e-3);
    EXPECT_LT(fine, 0.45 * coarse);
  }
}

}  // namespace
}  // namespace silt::lbm

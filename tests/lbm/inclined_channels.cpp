// Flow between plane walls at any angle to the lattice, anywhere in it, against the parabola and the straight
// line that it has; with wider cells along the middle too.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/lbm/levelled_cut.hpp"
#include "tests/lbm/walled_box.hpp"

namespace silt::lbm {
namespace {

/// Walls along normal.x = first and first + width |normal|; the box has the normal's own period.
struct InclinedChannel {
  Int3 normal;
  double width, first;  // cells; in units of normal.x
  double finest = 0;    // cells from a wall up to which they are finest; 0: all are
  static constexpr int tile = 4;

  double length() const {
    return std::sqrt(double(normal.x * normal.x + normal.y * normal.y + normal.z * normal.z));
  }
  int sum() const { return normal.x + normal.y + normal.z; }
  int period() const {
    const int n = int(std::ceil(width * length())) + 2 * sum();
    return finest > 0 ? (n + tile - 1) / tile * tile : n;
  }
  /// normal.x from the first wall on.
  double across(Point p) const {
    const double s = normal.x * p.x + normal.y * p.y + normal.z * p.z - first;
    return s - period() * std::floor(s / period());
  }
  WalledScene scene() const {
    const auto cells = [&](int n) { return n ? period() : finest > 0 ? tile : 2; };
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
  /// A tile is coarse if all of it is far enough from both walls.
  int level(Int3 x) const {
    const auto low = [](int n) { return double(n / tile * tile); };
    const double s = across({low(x.x), low(x.y), low(x.z)}), least = finest * length();
    return finest > 0 && s >= least && s + tile * sum() <= width * length() - least ? 1 : 0;
  }
  CutTree tree() const {
    return testing::LevelledCut(scene().cells, finest > 0 ? tile : period(), [&](Int3 x) { return level(x); })
        .tree();
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
  int least_steps = 2000;
  double times = 3;  // of width^2 / nu: 30 e-foldings of the slowest mode
};

/// The largest difference of a cell's velocity from the true one, over the mean of the true flow, after the
/// flow has become steady.
double velocity_error(const InclinedChannel& channel, WallScheme scheme, const Drive& drive) {
  const auto t = channel.along(drive.along);
  const double nu = (drive.tau - 0.5) / 3, width = channel.width;
  WalledBox flow(
      channel.scene(), scheme,
      {drive.tau, drive.magic, Collision::trt, {drive.force * t[0], drive.force * t[1], drive.force * t[2]}},
      channel.tree(), channel.finest > 0 ? 1 : 0);
  for (int d = 0; d < 3; ++d) flow.motions[1].v[d] = drive.speed * t[d];
  const auto exact = [&](const testing::Vector& p) {
    const double z = channel.across({p[0], p[1], p[2]}) / channel.length();
    return drive.force * z * (width - z) / (2 * nu) + drive.speed * z / width;
  };
  flow.flow().set([&](const testing::Vector& p, double&, testing::Vector& u, auto& gradient) {
    const double z = channel.across({p[0], p[1], p[2]}) / channel.length(), l = channel.length(),
                 shear = drive.force * (width / 2 - z) / nu + drive.speed / width;
    const double n[3] = {channel.normal.x / l, channel.normal.y / l, channel.normal.z / l};
    for (int d = 0; d < 3; ++d) {
      u[d] = exact(p) * t[d];
      for (int e = 0; e < 3; ++e) gradient[d][e] = shear * n[e] * t[d];
    }
  });
  for (int n = 0; n < drive.least_steps + int(drive.times * width * width / nu) / 2 * 2; ++n) flow.step();
  double worst = 0;
  flow.flow().for_all([&](Fluid<double>& fluid, int b, Int3 x, const testing::Vector& p, int) {
    if (channel.across({p[0], p[1], p[2]}) >= width * channel.length()) return;
    const auto u = fluid.velocity(fluid.moments(b, x));
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

// A border between levels along the middle is a second-order error, of which each cell sees no more than
// this; across edges of the border, where the flow has a component along the steps, it is of first order.
TEST(InclinedChannels, BorderAlongTheMiddleKeepsTheParabola) {
  const auto error = [](Int3 normal, double width, double finest, int along, double times) {
    return velocity_error({normal, width, 3.1, finest}, WallScheme::multireflection,
                          {1, 1.0 / 7, 1e-9, 0, along, 0, times});
  };
  EXPECT_LT(error({0, 1, 0}, 32.37, 8, 0, 0.4), 0.0011);
  EXPECT_LT(error({0, 1, 0}, 32.37, 8, 0, 0.4), 0.27 * error({0, 1, 0}, 16.37, 4, 0, 0.4));
  EXPECT_LT(error({1, 2, 0}, 16.37, 4, 1, 0.3), 0.01);
  EXPECT_LT(error({1, 1, 1}, 16.37, 4, 1, 0.1), 0.015);
}

// Shear is exact through plane faces of a border, and along its edges.
TEST(InclinedChannels, ShearIsExactThroughABorder) {
  for (const Int3 normal : {Int3{0, 1, 0}, Int3{1, 2, 0}})
    EXPECT_LT(velocity_error({normal, 16.37, 3.1, 4}, WallScheme::multireflection,
                             {1, 1.0 / 7, 0, 1e-7, 1, 0, 0.2}),
              1e-5)
        << normal.x;
}

}  // namespace
}  // namespace silt::lbm

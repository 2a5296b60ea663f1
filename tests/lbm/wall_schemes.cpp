// Each wall scheme at a flat wall, against the closure of method.md, equation 12: flow driven
// by a force between two planes anywhere in the grid.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/lbm/walled_box.hpp"

namespace silt::lbm {
namespace {

struct Channel {
  double tau, magic;
  double below, above;  // wall distances of the first and the last layer of cells
  int layers;
  double force = 1e-6, speed = 0;  // along x; of the upper wall
  bool paired = false;             // one layer: each link knows the other wall
  Collision model = Collision::trt;
  CollisionSpec spec() const { return {tau, magic, model, {force, 0, 0}}; }
};

/// Between two planes across z; along x and y nothing changes.
WalledScene scene_of(const Channel& channel) {
  return {{4, 4, channel.layers + 2},
          [=](Point p) { return p.z > 1 && p.z < channel.layers + 1; },
          [=](Point p, Int3 v) {
            if (v.z < 0 && p.z < 2) return Hit{channel.below, 0};
            return v.z > 0 && p.z > channel.layers ? Hit{channel.above, 1} : Hit{2, 0};
          }};
}

/// Lets the links know of a wall that moves along x, on their other side.
void set_far_wall(CutLinks<double>& links, double q, double speed) {
  for (const std::uint32_t place : links.place)
    links.opposite_q.push_back(q), links.opposite_u.push_back(D3Q19::c[place_direction(place)].x * speed);
}

/// The steady velocity along x of every layer.
std::vector<double> velocities(const Channel& channel, WallScheme scheme) {
  WalledBox flow(scene_of(channel), scheme, channel.spec());
  flow.keeps_mass = true;
  flow.motions[1].v[0] = channel.speed;
  if (channel.paired)
    set_far_wall(flow.links(0), channel.above, channel.speed), set_far_wall(flow.links(1), channel.below, 0);
  std::vector<double> u(channel.layers), before;
  const auto steady = [&] {
    before = u;
    for (int k = 0; k < channel.layers; ++k) u[k] = flow.velocity({1, 2, k + 1})[0];
    double change = 0, largest = 0;
    for (int k = 0; k < channel.layers; ++k)
      change = std::max(change, std::fabs(u[k] - before[k])), largest = std::max(largest, std::fabs(u[k]));
    return change < 1e-14 * largest;
  };
  for (int t = 1; t % 250 != 0 || !(steady() || t > 50000); ++t) flow.step();
  return u;
}

/// The T of the closure, and the distance at which it sees the wall.
struct Closure {
  double t, distance;
};
Closure closure_of(WallScheme scheme, double q, const Channel& channel) {
  const CollisionSpec spec = channel.spec();
  const double rate = spec.excess(), magic = spec.magic_in_effect();
  const double least = magic + least_excess * (0.5 + q);
  if (scheme == WallScheme::bounce_back) return {magic, 0.5};
  if (scheme == WallScheme::single_cell_gap) {
    const double h = std::max(q, least_gap_distance);
    return {2 * h * magic, h};
  }
  if (scheme == WallScheme::parabolic) return {std::max(least, parabola * q * q), q};
  if (scheme == WallScheme::cli) return {least, q};
  if (scheme ==
      WallScheme::multireflection) {  // the mean of 3/4 q^2 and of the rest, weighted with k of each
    const double share = stable_share(spec);
    const double t = std::max(least, magic + parabolic_share(spec) * (parabola * q * q - magic));
    const double whole = share * 2 / ((1 + q) * (1 + q)), rest = (1 - share) / (0.5 + q + (t - magic) / rate);
    return {(whole * 0.75 * q * q + rest * t) / (whole + rest), q};
  }
  return {magic + std::fabs(q - 0.5) * rate, q};
}

/// The largest difference, over the largest velocity, from the flow with u'' = -force / nu that fulfils
/// u + distance u' + 2/3 T u'' = u_w at both walls (a third of d^2 u is taken up by the force).
double difference(const Channel& channel, WallScheme scheme) {
  const WallScheme held = channel.layers == 1 ? WallScheme::single_cell_gap : scheme;
  const Closure low = closure_of(held, channel.below, channel),
                high = closure_of(held, channel.above, channel);
  const double curvature = -3 * channel.force / (channel.tau - 0.5), last = channel.layers - 1;
  // u = a + b z + curvature z^2 / 2, z from the first layer
  const double at_low = -2 / 3. * low.t * curvature;
  const double at_high =
      channel.speed - 2 / 3. * high.t * curvature - curvature * last * (last / 2 + high.distance);
  const double b = (at_high - at_low) / (last + high.distance + low.distance), a = at_low + b * low.distance;
  const std::vector<double> u = velocities(channel, scheme);
  double largest = 0, off = 0;
  for (int k = 0; k < channel.layers; ++k) {
    largest = std::max(largest, std::fabs(u[k]));
    off = std::max(off, std::fabs(u[k] - (a + b * k + curvature * k * k / 2)));
  }
  return off / largest;
}

const double distances[][2] = {{0.5, 0.5}, {0.07, 0.93}, {0.31, 0.64}, {1, 0.26}};
const double rates[][2] = {{0.6, 1. / 24}, {0.8, 1. / 6}, {1, 1. / 6}, {1.7, 3. / 16}, {3, 1. / 24}};

TEST(WallSchemes, HoldTheirClosures) {
  for (const auto scheme :
       {WallScheme::bounce_back, WallScheme::cli, WallScheme::parabolic, WallScheme::multireflection})
    for (const auto& q : distances)
      for (const auto& r : rates)
        EXPECT_LT(difference({r[0], r[1], q[0], q[1], 4}, scheme), 1e-10)
            << wall_scheme_names[int(scheme)] << " tau " << r[0] << " q " << q[0] << " " << q[1];
}

// At low viscosity regularised has a small Lambda, and the rest of multireflection the T of parabolic.
TEST(WallSchemes, HoldTheirClosuresWhereRegularisedLowersMagic) {
  for (const auto scheme : {WallScheme::cli, WallScheme::parabolic, WallScheme::multireflection})
    for (const auto& q : distances)
      for (const double tau : {0.53, 0.57}) {
        Channel channel{tau, 1. / 6, q[0], q[1], 3};
        channel.model = Collision::regularised;
        EXPECT_LT(difference(channel, scheme), 1e-8)
            << wall_scheme_names[int(scheme)] << " tau " << tau << " q " << q[0] << " " << q[1];
      }
}

TEST(WallSchemes, HoldMovingWalls) {
  for (const auto scheme : {WallScheme::cli, WallScheme::parabolic, WallScheme::multireflection})
    for (const auto& q : distances)
      EXPECT_LT(difference({0.8, 1. / 12, q[0], q[1], 3, 1e-6, 0.01}, scheme), 1e-10)
          << wall_scheme_names[int(scheme)] << " q " << q[0] << " " << q[1];
}

/// Returns how far the discharge of a channel, of two cells and more across, differs from that between its
/// true walls.
double discharge_spread(WallScheme scheme, double magic) {
  double least = 1e9, most = -1e9;
  for (const double below : {0.02, 0.2, 0.4, 0.6, 0.8, 1.0}) {
    const Channel channel{1, magic, below, std::max(1.02 - below, 0.02), 5};
    const double height = channel.layers - 1 + channel.below + channel.above;
    double sum = 0, exact = 0;
    const std::vector<double> u = velocities(channel, scheme);
    for (int k = 0; k < channel.layers; ++k) {
      const double z = k + channel.below;
      sum += u[k], exact += 3 * channel.force * z * (height - z);
    }
    least = std::min(least, sum / exact), most = std::max(most, sum / exact);
  }
  return most - least;
}

// A channel of five cells, wherever its walls are in the grid.
TEST(WallSchemes, ParabolicDependsLeastOnWhereTheWallIs) {
  const double linear = discharge_spread(WallScheme::cli, 1.0 / 6);
  const double parabolic = discharge_spread(WallScheme::parabolic, 1.0 / 16);
  printf("discharge of a channel: cli %.4f, parabolic %.4f\n", linear, parabolic);
  EXPECT_LT(parabolic, 0.3 * linear);
}

TEST(WallSchemes, OneLayerOfCellsBetweenTwoWalls) {
  for (const auto& q : {std::array{0.6, 0.6}, std::array{0.9, 0.55}, std::array{0.2, 0.7}})
    for (const auto& r : rates)
      EXPECT_LT(difference({r[0], r[1], q[0], q[1], 1}, WallScheme::cli), 1e-10)
          << "tau " << r[0] << " q " << q[0] << " " << q[1];
}

// Driven and sheared, and its velocity that of the true flow, at any viscosity.
TEST(WallSchemes, OneLayerOfCellsKnowsTheParabolaThroughBothWalls) {
  for (const auto& q : {std::array{0.6, 0.6}, std::array{0.9, 0.55}, std::array{1.0, 1.0}})
    for (const auto& r : rates) {
      const Channel channel{r[0], r[1], q[0], q[1], 1, 1e-6, 1e-5, true};
      const double exact =
          channel.speed * q[0] / (q[0] + q[1]) + channel.force * q[0] * q[1] / 2 / ((channel.tau - 0.5) / 3);
      EXPECT_NEAR(velocities(channel, WallScheme::cli)[0] / exact, 1, 1e-9)
          << "tau " << r[0] << " q " << q[0] << " " << q[1];
    }
}

}  // namespace
}  // namespace silt::lbm

#pragma once
// Loose beds of bodies about to settle in an open box, for benchmarks: the same for every code that runs
// them.
#include <cmath>
#include <random>
#include <vector>

#include "rigid/shapes/shape.hpp"

namespace silt::bench {

/// In SI units, at sizes that Bullet is made for (about 1 m). Density 1000 kg/m^3.
struct Bed {
  struct Body {
    int shape;
    rigid::Pose pose;
  };
  std::vector<rigid::Shape> shapes;
  std::vector<Body> bodies;
  rigid::Vec3 size = rigid::Vec3::Zero();  // of the box; no lid

  static constexpr double density = 1000, restitution = 0.3, friction = 0.4, gravity = 9.81;
};

/// The points (spacing times): square layers, every other one shifted by half a spacing, so that a body lies
/// in the hollow of four others.
inline rigid::Vec3 layered(int i, int j, int layer, double spacing, double layer_height) {
  const double shift = layer % 2 ? 0.75 : 0.25;
  return {(i + 0.25 + shift) * spacing, (j + 0.25 + shift) * spacing, (layer + 0.7) * layer_height};
}

inline rigid::Vec3 in_unit_ball(std::mt19937_64& random) {
  std::uniform_real_distribution<> u(-1, 1);
  for (;;)
    if (const rigid::Vec3 x(u(random), u(random), u(random)); x.norm() <= 1) return x;
}

/// `count` spheres of radii from 1 - spread to 1 times 0.5 m, across x across a layer, the largest 2 x spare
/// of a radius apart before they are jittered.
inline Bed loose_spheres(int count, int across, double spare, double spread) {
  constexpr int classes = 16;
  constexpr double largest = 0.5;
  Bed bed;
  for (int k = 0; k < classes; ++k)
    bed.shapes.push_back(rigid::Sphere{largest * (1 - spread * k / (classes - 1))});
  const double spacing = 2 * largest * (1 + spare), jitter = 0.5 * spare * spacing;
  std::mt19937_64 random(1);
  for (int n = 0; n < count; ++n) {
    const int layer = n / (across * across);
    const rigid::Vec3 x = layered(n % across, n / across % across, layer, spacing, spacing * std::sqrt(0.5)) +
                          jitter * in_unit_ball(random);
    bed.bodies.push_back({static_cast<int>(random() % classes), {x, rigid::Quat::Identity()}});
  }
  const double edge = (across + 1) * spacing;
  bed.size = {edge, edge, 100};
  return bed;
}

/// `count` bodies of one shape some 1 m across, tilted by up to `largest_tilt` (radian).
inline Bed loose_bodies(const rigid::Shape& shape, int count, int across, double largest_tilt) {
  constexpr double spacing = 1.2;
  Bed bed;
  bed.shapes.push_back(shape);
  std::mt19937_64 random(2);
  for (int n = 0; n < count; ++n) {
    const int layer = n / (across * across);
    const rigid::Vec3 tilt = largest_tilt * in_unit_ball(random);
    const rigid::Quat q(Eigen::AngleAxisd(tilt.norm(), tilt.normalized()));
    bed.bodies.push_back({0, {layered(n % across, n / across % across, layer, spacing, spacing), q}});
  }
  const double edge = (across + 1) * spacing;
  bed.size = {edge, edge, 100};
  return bed;
}

/// `count` boxes of 1 x 0.9 x 0.8 m.
inline Bed loose_boxes(int count, int across) {
  return loose_bodies(rigid::Box{{0.5, 0.45, 0.4}}, count, across, 0.15);
}

/// `count` cylinders of 0.8 m, as long as wide, lying any way.
inline Bed loose_cylinders(int count, int across) {
  return loose_bodies(rigid::Cylinder{0.4, 0.4}, count, across, 3);
}

}  // namespace silt::bench

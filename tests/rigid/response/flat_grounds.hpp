#pragma once
// A ball, and what it may lie on that is flat.
#include <utility>
#include <vector>

#include "rigid/math/types.hpp"
#include "tests/rigid/scene.hpp"
#include "tests/rigid/shapes/meshes.hpp"
#include "tests/rigid/shapes/solids.hpp"

namespace silt::rigid::testing {

constexpr double ball_radius = 0.1, time_step = 1e-3;

/// Fixed bodies whose upper face is flat, and where their centre is below it.
inline std::vector<std::pair<Shape, double>> flat_grounds() {
  std::vector<std::pair<Shape, double>> all;
  for (const double thick : {0.01, 0.2, 3.0}) {
    const Vec3 half(6, 5, thick / 2);
    all.push_back({Box{half}, thick / 2});
    all.push_back({cuboid(-half, half), thick / 2});
    all.push_back({solid_of(cuboid_mesh(-half, half)), thick / 2});
    all.push_back({Cylinder{6, thick / 2}, thick / 2});
  }
  return all;
}

/// A body `height` above such a plate, the plate fixed at height 10; row 0 is the body.
inline Scene on_plate(const std::pair<Shape, double>& plate, const Shape& body, double height,
                      const Quat& q = Quat::Identity()) {
  Scene s(0, 0.9);
  s.add_with_id(0, s.shape(body), {Vec3(10, 10, 10 + height), q});
  s.add_with_id(1, s.shape(plate.first), {Vec3(11, 9, 10 - plate.second)});
  s.bodies.motion[s.row(1)] = Motion::fixed;
  return s;
}

}  // namespace silt::rigid::testing

#pragma once
// Balls inside a shape that touch its boundary at a point: what proves a depth of overlap the least one
// (rigid/collision/depth_proof.hpp).
#include <algorithm>
#include <limits>

#include "rigid/math/types.hpp"

namespace silt::rigid {

/// Radius of the largest ball that touches the plane normal to unit n at a point from below and stays below
/// the planes added.
struct BallUnderPlanes {
  explicit BallUnderPlanes(const Vec3& normal) : n(normal) {}

  /// A plane with unit `outward` normal, which the point is `below` it (lattice units).
  void add(const Vec3& outward, double below) {
    const double turned = (outward - n).squaredNorm() / 2;  // 1 - cosine
    if (turned > same_plane) radius = std::min(radius, std::max(below, 0.0) / turned);
  }

  Vec3 n;
  double radius = std::numeric_limits<double>::infinity();

 private:
  /// Half the square of an angle below which two directions are one.
  static constexpr double same_plane = 1e-18;
};

}  // namespace silt::rigid

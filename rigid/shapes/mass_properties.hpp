#pragma once
// Volume, centre and inertia of a solid of unit density.
#include "rigid/math/types.hpp"

namespace silt::rigid {

/// The inertia is about the centre of mass, in the axes of the shape's frame.
struct MassProperties {
  double volume;
  Vec3 centre;
  Mat3 inertia;
};

/// Integrals of 1, x and x x^T over a solid of unit density.
struct SolidMoments {
  double volume = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();

  SolidMoments& operator+=(const SolidMoments& o) {
    volume += o.volume;
    first += o.first;
    second += o.second;
    return *this;
  }
  SolidMoments operator-(const SolidMoments& o) const {
    return {volume - o.volume, first - o.first, second - o.second};
  }
  SolidMoments operator*(double s) const { return {s * volume, s * first, s * second}; }
};

/// Returns the moments in the frame in which the solid has this pose.
SolidMoments moments(const MassProperties&, const Pose&);
/// Returns the inertia that belongs to second moments about the centre.
Mat3 inertia_of(const Mat3& second);
/// Rounds differences below the relative integration error `error` to exact symmetry: the centre of a star is
/// its origin, and a body with equal moments needs no gyroscopic term.
void snap_to_symmetry(MassProperties&, double error);

}  // namespace silt::rigid

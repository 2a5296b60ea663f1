#pragma once
// Volume, centre and inertia of a solid of unit density.
#include "rigid/math/types.hpp"

namespace silt::rigid {

/// The inertia is taken about the centre of mass, in the axes of the shape as given.
struct MassProperties {
  double volume;
  Vec3 centre;
  Mat3 inertia;
};

/// Integrals over a solid of unit density: of 1, of x and of x x^T.
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

/// The moments in the frame in which the solid has this pose.
SolidMoments moments(const MassProperties&, const Pose&);
/// The inertia of a solid whose second moments about its centre are these.
Mat3 inertia_of(const Mat3& second);
/// Values below `error` (relative to the size), that of the integration, become what symmetry would make
/// them: a star's centre is its centre, and a body with equal moments needs no gyroscopic term.
void snap_to_symmetry(MassProperties&, double error);

}  // namespace silt::rigid

#pragma once
// By how much the parts of a compound, added up one by one, count their overlaps too often.
#include <span>

#include "rigid/shapes/shape.hpp"

namespace silt::rigid {

/// Integrals over a solid of unit density: of 1, of x and of x x^T.
struct SolidMoments {
  double volume = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();

  SolidMoments& operator+=(const SolidMoments& o) {
    volume += o.volume, first += o.first, second += o.second;
    return *this;
  }
  SolidMoments operator-(const SolidMoments& o) const {
    return {volume - o.volume, first - o.first, second - o.second};
  }
  SolidMoments operator*(double s) const { return {s * volume, s * first, s * second}; }
};

/// Sum of the parts' moments minus the moments of their union, in the body frame. Along parallel rays the
/// intervals are exact; across them adaptive Gauss cubature. The rays have a direction in general position,
/// so that no flat face lies along them and the integrand is continuous. Relative error about 1e-5.
SolidMoments overlap_moments(std::span<const Part> parts);

}  // namespace silt::rigid

#include "rigid/shapes/mass_properties.hpp"

#include <cmath>

namespace silt::rigid {

SolidMoments moments(const MassProperties& p, const Pose& pose) {
  const Mat3 r = pose.orientation.toRotationMatrix();
  const Mat3 inertia = r * p.inertia * r.transpose();
  const Vec3 centre = pose.to_world(p.centre);
  SolidMoments m;
  m.volume = p.volume;
  m.first = p.volume * centre;
  m.second = 0.5 * inertia.trace() * Mat3::Identity() - inertia + p.volume * centre * centre.transpose();
  return m;
}

Mat3 inertia_of(const Mat3& second) {
  const Mat3 inertia = second.trace() * Mat3::Identity() - second;
  return 0.5 * (inertia + inertia.transpose());
}

void snap_to_symmetry(MassProperties& p, double error) {
  const double size = std::sqrt(p.inertia.trace() / p.volume);
  for (int d = 0; d < 3; ++d)
    if (std::abs(p.centre[d]) < error * size) p.centre[d] = 0;
  Mat3& i = p.inertia;
  const double tolerance = error * i.trace();
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      if (a != b && std::abs(i(a, b)) < tolerance) i(a, b) = 0;
  const double mean = i.trace() / 3;
  if ((i.diagonal().array() - mean).abs().maxCoeff() < tolerance) {
    i.diagonal().setConstant(mean);
    return;
  }
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3;
    if (std::abs(i(a, a) - i(b, b)) < tolerance) i(a, a) = i(b, b) = 0.5 * (i(a, a) + i(b, b));
  }
}

}  // namespace silt::rigid

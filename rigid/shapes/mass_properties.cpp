// Volume, centre and inertia of unit density.
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "rigid/shapes/overlap_quadrature.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::rigid {

namespace {

using std::numbers::pi;

MassProperties of(const Sphere& s) {
  const double volume = 4.0 / 3 * pi * s.radius * s.radius * s.radius;
  return {volume, Vec3::Zero(), 0.4 * volume * s.radius * s.radius * Mat3::Identity()};
}

MassProperties of(const Box& b) {
  const Vec3 sq = b.half_edges.cwiseAbs2();
  const double volume = 8 * b.half_edges.prod();
  const Vec3 moments = volume / 3 * Vec3(sq[1] + sq[2], sq[0] + sq[2], sq[0] + sq[1]);
  return {volume, Vec3::Zero(), moments.asDiagonal()};
}

MassProperties of(const Capsule& c) {
  const double r2 = c.radius * c.radius, l = c.half_length;
  const double barrel = 2 * pi * r2 * l, ends = 4.0 / 3 * pi * r2 * c.radius;
  const double along = 0.5 * barrel * r2 + 0.4 * ends * r2;
  const double across = barrel * (0.25 * r2 + l * l / 3) + ends * (0.4 * r2 + l * l + 0.75 * c.radius * l);
  return {barrel + ends, Vec3::Zero(), Vec3(across, across, along).asDiagonal()};
}

MassProperties of(const Cylinder& c) {
  const double r2 = c.radius * c.radius, l = c.half_length, volume = 2 * pi * r2 * l;
  const double across = volume * (0.25 * r2 + l * l / 3);
  return {volume, Vec3::Zero(), Vec3(across, across, 0.5 * volume * r2).asDiagonal()};
}

MassProperties of(const Ellipsoid& e) {
  const Vec3 sq = e.half_axes.cwiseAbs2();
  const double volume = 4.0 / 3 * pi * e.half_axes.prod();
  return {volume, Vec3::Zero(),
          0.2 * volume * Vec3(sq[1] + sq[2], sq[0] + sq[2], sq[0] + sq[1]).asDiagonal()};
}

MassProperties of(const HalfSpace&) {
  throw std::invalid_argument("a half-space has no mass");
}
MassProperties of(const Tube&) {
  throw std::invalid_argument("a tube has no mass");
}

/// Integrals of 1, x, x x^T from volume, centre and inertia about the centre.
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

/// Values below the error of the integration become what symmetry would make them: a star's centre is its
/// centre, and a body with equal moments needs no gyroscopic term.
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

/// From second moments about the centre.
Mat3 inertia_of(const Mat3& second) {
  const Mat3 inertia = second.trace() * Mat3::Identity() - second;
  return 0.5 * (inertia + inertia.transpose());
}

MassProperties of(const Polyhedron& q) {
  constexpr double rounding = 1e-13;
  const PolyhedronIntegrals sum = integrals(*q.mesh);
  const Vec3 centre = sum.first / sum.volume;
  MassProperties p{sum.volume, sum.about + centre,
                   inertia_of(sum.second - sum.volume * centre * centre.transpose())};
  snap_to_symmetry(p, rounding);
  return p;
}

MassProperties of(const Compound& c) {
  constexpr double quadrature_error = 2e-5;  // a fifth of what is promised
  SolidMoments m;
  for (const Part& part : c.parts)
    m += moments(std::visit([](const auto& s) { return of(s); }, part.shape), part.pose);
  m = m - overlap_moments(c.parts);
  MassProperties p;
  p.volume = m.volume;
  p.centre = m.first / m.volume;
  p.inertia = inertia_of(m.second - m.volume * p.centre * p.centre.transpose());
  snap_to_symmetry(p, quadrature_error);
  return p;
}

}  // namespace

MassProperties mass_properties(const Shape& shape) {
  return std::visit([](const auto& s) { return of(s); }, shape);
}

}  // namespace silt::rigid

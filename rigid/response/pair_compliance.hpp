#pragma once
// How a pair answers an impulse: the velocities that it gives its bodies, each with its share of mass.
#include <algorithm>
#include <cmath>

#include "rigid/response/pair_lanes.hpp"

namespace silt::rigid {

/// [r]x m [r]x, without the products by zero.
inline Mat3 crossed_on_both_sides(const Vec3& r, const Mat3& m) {
  Mat3 crossed, both;
  for (int column = 0; column < 3; ++column) crossed.col(column) = r.cross(m.col(column));
  for (int row = 0; row < 3; ++row) both.row(row) = crossed.row(row).cross(r.transpose());
  return both;
}

/// Of both together, along each axis.
inline Vec3 inverse_masses(const PairToSolve& p) {
  const double a = p.share_a * p.a.inverse_mass, b = p.share_b * p.b.inverse_mass;
  if (!p.a.locked && !p.b.locked) return Vec3::Constant(a + b);
  return without_locked(p.a.locked, Vec3::Constant(a)) + without_locked(p.b.locked, Vec3::Constant(b));
}

/// Relative velocity at the contact by a unit impulse there.
inline Mat3 compliance(const PairToSolve& p, const Contact& c) {
  return Mat3(inverse_masses(p).asDiagonal()) -
         crossed_on_both_sides(c.r_a, p.share_a * p.a.inverse_inertia) -
         crossed_on_both_sides(c.r_b, p.share_b * p.b.inverse_inertia);
}

/// The larger eigenvalue of k between directions across n, k n being k_n.
inline double tangential_eigenvalue(const Mat3& k, const Vec3& n, const Vec3& k_n) {
  const double normal = n.dot(k_n), sum = k.trace() - normal;
  const double squares = k.squaredNorm() - 2 * k_n.squaredNorm() + normal * normal;
  return 0.5 * (sum + std::sqrt(std::max(0.0, 2 * squares - sum * sum)));
}

/// The inverse of the compliance of a motion; of one that nothing moves 0.
inline double inverse(double k) {
  return k > 0 ? 1 / k : 0;
}

/// Share of a velocity of compliance k that a resistance takes away; impulse z per velocity.
inline double damped(double z, double k) {
  return z * k / (1 + z * k);
}

}  // namespace silt::rigid

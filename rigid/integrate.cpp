#include "rigid/integrate.hpp"

#include <cmath>

#include "rigid/math/elementary.hpp"
#include "rigid/math/twist.hpp"

namespace silt::rigid {

namespace {

Mat3 cross_matrix(const Vec3& a) {
  Mat3 m;
  m << 0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0;
  return m;
}

/// A quaternion that is off unit length by rounding, brought back without a root.
Quat renormalised(const Quat& q) {
  return Quat((1.5 - 0.5 * q.squaredNorm()) * q.coeffs());
}

/// The midpoint angular velocity in the body frame, by Newton's method to round-off.
Vec3 midpoint_angular_velocity(const Mat3& inverse, const Vec3& start, double h) {
  constexpr int cap = 20;              // quadratic convergence: 4 is usual
  constexpr double round_off = 4e-16;  // relative to |L|
  const double length = start.norm();
  Vec3 end = start, mean = start, omega = inverse * start;
  for (int i = 0; i < cap && length > 0; ++i) {
    const Vec3 residual = end - start - h * mean.cross(omega);
    if (residual.norm() <= round_off * length && i > 0) break;
    const Mat3 slope = Mat3::Identity() - 0.5 * h * (cross_matrix(mean) * inverse - cross_matrix(omega));
    end -= slope.inverse() * residual;
    mean = 0.5 * (start + end);
    omega = inverse * mean;
  }
  return omega;
}

void drift_free(BodySet& b, std::size_t row, double h) {
  b.position[row] += h * b.velocity[row];
  const Vec3& momentum = b.angular_momentum[row];
  if (momentum.squaredNorm() == 0) {
    b.angular_velocity[row].setZero();
    return;
  }
  if (b.is_isotropic(row)) {  // omega is constant, and parallel to L
    b.angular_velocity[row] = momentum / b.inertia_B[row](0, 0);
    b.orientation[row] = renormalised(cayley(h * b.angular_velocity[row]) * b.orientation[row]);
    return;
  }
  b.orientation[row] = free_rotation(b.orientation[row], b.inertia_B[row], momentum, h);
  b.angular_velocity[row] = b.inverse_inertia_W(row) * momentum;
}

}  // namespace

Quat free_rotation(const Quat& q, const Mat3& inertia_B, const Vec3& angular_momentum_W, double h) {
  const Vec3 momentum_B = q.conjugate() * angular_momentum_W;
  const Vec3 omega_B = midpoint_angular_velocity(inertia_B.inverse(), momentum_B, h);
  return renormalised(q * cayley(h * omega_B));
}

Quat rotation_by(const Vec3& angle) {
  const double size = angle.norm();
  if (size == 0) return Quat::Identity();
  const Vec3 v = elementary::sin(0.5 * size) / size * angle;
  return Quat(elementary::cos(0.5 * size), v[0], v[1], v[2]);
}

void drift(BodySet& b, double h) {
  for (std::size_t row = 0; row < b.owned; ++row) {
    if (b.motion[row] == Motion::free) {
      drift_free(b, row, h);
    } else if (b.motion[row] == Motion::prescribed) {
      b.position[row] += h * b.velocity[row];
      b.orientation[row] = (rotation_by(h * b.angular_velocity[row]) * b.orientation[row]).normalized();
    }
  }
}

}  // namespace silt::rigid

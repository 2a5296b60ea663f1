#include "rigid/rigid_step.hpp"

namespace silt::rigid {
namespace {

Mat3 cross_matrix(const Vec3& a) {
  Mat3 m;
  m << 0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0;
  return m;
}

/// Solves matrix x = right by Cramer's rule.
Vec3 solution(const Mat3& matrix, const Vec3& right) {
  const Vec3 a = matrix.col(0), b = matrix.col(1), c = matrix.col(2), b_c = b.cross(c);
  return Vec3(right.dot(b_c), a.dot(right.cross(c)), a.dot(b.cross(right))) / a.dot(b_c);
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
    end -= solution(slope, residual);
    mean = 0.5 * (start + end);
    omega = inverse * mean;
  }
  return omega;
}

Quat rotated_freely(const Quat& q, const Mat3& inverse_inertia_B, const Vec3& momentum_B, double h) {
  return renormalised(q * cayley(h * midpoint_angular_velocity(inverse_inertia_B, momentum_B, h)));
}

void drift_free(BodySet& b, std::size_t row, double h) {
  b.position[row] += h * b.velocity[row];
  const Vec3& momentum = b.angular_momentum[row];
  if (b.locked(row) & locked_rotations) {
    b.angular_velocity[row] = b.inverse_inertia_W(row) * momentum;
    b.orientation[row] = (rotation_by(h * b.angular_velocity[row]) * b.orientation[row]).normalized();
    return;
  }
  if (momentum.squaredNorm() == 0) {
    b.angular_velocity[row].setZero();
    return;
  }
  if (b.is_isotropic(row)) {  // omega is constant, and parallel to L
    b.angular_velocity[row] = momentum / b.inertia_B[row](0, 0);
    b.orientation[row] = renormalised(cayley(h * b.angular_velocity[row]) * b.orientation[row]);
    return;
  }
  const Mat3 inverse = b.inertia_B[row].inverse();
  Quat& q = b.orientation[row];
  q = rotated_freely(q, inverse, q.conjugate() * momentum, h);
  b.angular_velocity[row] = q * Vec3(inverse * (q.conjugate() * momentum));
}

}  // namespace

Quat free_rotation(const Quat& q, const Mat3& inertia_B, const Vec3& angular_momentum_W, double h) {
  return rotated_freely(q, inertia_B.inverse(), q.conjugate() * angular_momentum_W, h);
}

void drift(BodySet& b, std::size_t rows, double h) {
  for (std::size_t row = 0; row < rows; ++row) {
    if (b.is_dynamic(row)) {
      drift_free(b, row, h);
    } else if (b.motion[row] == Motion::prescribed) {
      b.position[row] += h * b.velocity[row];
      b.orientation[row] = (rotation_by(h * b.angular_velocity[row]) * b.orientation[row]).normalized();
    }
  }
}

}  // namespace silt::rigid

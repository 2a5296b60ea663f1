#include "rigid/bodies/prescribed_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "rigid/math/elementary.hpp"

namespace silt::rigid {
namespace {

double in_table(const std::vector<OverTime::Row>& table, double time) {
  if (time <= table.front().time) return table.front().share;
  const auto next = std::upper_bound(table.begin(), table.end(), time,
                                     [](double t, const OverTime::Row& row) { return t < row.time; });
  if (next == table.end()) return table.back().share;
  const auto& [t0, s0] = *(next - 1);
  return s0 + (time - t0) / (next->time - t0) * (next->share - s0);
}

constexpr double full_turn = 2 * std::numbers::pi;

/// Displacement and rotation vector, or their rates.
struct Interpolated {
  Vec3 displacement = Vec3::Zero(), rotation = Vec3::Zero();
  Vec3 velocity = Vec3::Zero(), rate = Vec3::Zero();
};

/// Returns the slope at a row of the parabola through it and its neighbours; zero at the ends.
template <class Of>
Vec3 slope(const std::vector<MotionRow>& table, std::size_t k, Of of) {
  if (k == 0 || k + 1 == table.size()) return Vec3::Zero();
  const double before = table[k].time - table[k - 1].time, after = table[k + 1].time - table[k].time;
  const Vec3 left = (table[k].*of - table[k - 1].*of) / before,
             right = (table[k + 1].*of - table[k].*of) / after;
  return (after * left + before * right) / (before + after);
}

/// Bounds the derivative of the cubic between two rows by the largest norm of its Bernstein coefficients.
template <class Of>
double slope_bound(const std::vector<MotionRow>& table, std::size_t k, Of of) {
  const Vec3 first = slope(table, k, of), last = slope(table, k + 1, of);
  const Vec3 mean = (table[k + 1].*of - table[k].*of) / (table[k + 1].time - table[k].time);
  const double a = first.norm(), b = (3 * mean - first - last).norm(), c = last.norm();
  return b > std::max(a, c) ? (b * b - a * c) / (2 * b - a - c) : std::max(a, c);
}

/// Evaluates the cubic Hermite interpolation between two rows, and its derivative.
template <class Of>
std::pair<Vec3, Vec3> cubic(const std::vector<MotionRow>& table, std::size_t k, double time, Of of) {
  const double length = table[k + 1].time - table[k].time, s = (time - table[k].time) / length;
  const Vec3 a = table[k].*of, b = table[k + 1].*of;
  const Vec3 p = length * slope(table, k, of), q = length * slope(table, k + 1, of);
  const Vec3 c2 = 3 * (b - a) - 2 * p - q, c3 = 2 * (a - b) + p + q;
  return {a + s * (p + s * (c2 + s * c3)), (p + s * (2 * c2 + s * 3 * c3)) / length};
}

Interpolated at(const std::vector<MotionRow>& table, double time) {
  Interpolated found;
  if (table.empty()) return found;
  if (time <= table.front().time || table.size() == 1)
    return {table.front().displacement, table.front().rotation};
  if (time >= table.back().time) return {table.back().displacement, table.back().rotation};
  const auto next = std::upper_bound(table.begin(), table.end(), time,
                                     [](double t, const MotionRow& row) { return t < row.time; });
  const auto k = static_cast<std::size_t>(next - table.begin()) - 1;
  std::tie(found.displacement, found.velocity) = cubic(table, k, time, &MotionRow::displacement);
  std::tie(found.rotation, found.rate) = cubic(table, k, time, &MotionRow::rotation);
  return found;
}

/// Returns the angular velocity for a rotation vector and its rate (left Jacobian of SO(3)).
Vec3 angular_velocity_of(const Vec3& rotation, const Vec3& rate) {
  const double angle = rotation.norm();
  const double small = 1e-4;  // below it the next terms of the series are smaller than rounding
  const double a = angle < small ? 0.5 - angle * angle / 24 : (1 - elementary::cos(angle)) / (angle * angle);
  const double b = angle < small ? 1. / 6 - angle * angle / 120
                                 : (angle - elementary::sin(angle)) / (angle * angle * angle);
  return rate + a * rotation.cross(rate) + b * rotation.cross(rotation.cross(rate));
}

}  // namespace

double OverTime::at(double time) const {
  const double share = table.empty() ? 1 : in_table(table, time);
  return amplitude == 0 ? share : share + amplitude * elementary::sin(full_turn * frequency * time);
}

double OverTime::most() const {
  double share = table.empty() ? 1 : 0;
  for (const Row& row : table) share = std::max(share, std::abs(row.share));
  return share + std::abs(amplitude);
}

bool PrescribedMotion::moves() const {
  return !velocity.isZero(0) || !angular_velocity.isZero(0) || (!amplitude.isZero(0) && frequency != 0) ||
         table.size() > 1;
}

Pose PrescribedMotion::pose(const Pose& start, double time) const {
  const Interpolated moved = at(table, time);
  const Vec3 to =
      velocity * time + amplitude * elementary::sin(full_turn * frequency * time) + moved.displacement;
  const Vec3 turned = angular_velocity * time + moved.rotation;
  return {start.position + to, (rotation_by(turned) * start.orientation).normalized()};
}

PrescribedMotion::Velocity PrescribedMotion::velocity_at(double time) const {
  const Interpolated moved = at(table, time);
  const double swing = full_turn * frequency;
  return {velocity + amplitude * (swing * elementary::cos(swing * time)) + moved.velocity,
          angular_velocity + angular_velocity_of(moved.rotation, moved.rate)};
}

PrescribedMotion::Velocity PrescribedMotion::over_step(double time) const {
  const Pose from = pose({}, time), to = pose({}, time + 1);
  return {to.position - from.position, angle_of(to.orientation * from.orientation.conjugate())};
}

/// The angular velocity never exceeds the rate of the rotation vector: the Jacobian's norm is 1.
double PrescribedMotion::speed_bound(double radius) const {
  double along_table = 0;
  for (std::size_t k = 0; k + 1 < table.size(); ++k)
    along_table = std::max(along_table, slope_bound(table, k, &MotionRow::displacement) +
                                            radius * slope_bound(table, k, &MotionRow::rotation));
  return velocity.norm() + radius * angular_velocity.norm() +
         full_turn * std::abs(frequency) * amplitude.norm() + along_table;
}

}  // namespace silt::rigid

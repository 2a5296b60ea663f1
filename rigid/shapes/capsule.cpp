#include "rigid/shapes/capsule.hpp"

#include <numbers>

namespace silt::rigid {

using std::numbers::pi;

double Capsule::signed_distance(const Vec3& x) const {
  const double along = std::clamp(x[2], -half_length, half_length);
  return Vec3(x[0], x[1], x[2] - along).norm() - radius;
}

std::optional<LineInterval> Capsule::line_interval(const Vec3& o, const Vec3& d) const {
  const double a = d[0] * d[0] + d[1] * d[1], rho = std::sqrt(o[0] * o[0] + o[1] * o[1]);
  if (!(a > 0)) {
    if (rho > radius) return {};
    return in_slab(o[2], d[2], half_length + std::sqrt((radius - rho) * (radius + rho)));
  }
  const auto barrel = between_roots(a, o[0] * d[0] + o[1] * d[1], (rho - radius) * (rho + radius));
  if (!barrel) return {};
  // A line that crosses the infinite cylinder beyond the segment only crosses that end's cap.
  const auto end = [&](double t, bool entering) -> std::optional<double> {
    const double z = o[2] + t * d[2];
    if (std::abs(z) <= half_length) return t;
    const auto cap = in_ball(radius, o - Vec3(0, 0, std::copysign(half_length, z)), d);
    if (!cap) return {};
    return entering ? cap->enter : cap->leave;
  };
  const auto enter = end(barrel->enter, true);
  if (!enter) return {};
  const auto leave = end(barrel->leave, false);
  if (!leave) return {};
  return LineInterval{*enter, *leave};
}

BoundingBox Capsule::bounding_box(const Pose& pose) const {
  const Vec3 axis = pose.orientation * Vec3::UnitZ();
  return BoundingBox::around(pose.position, axis.cwiseAbs() * half_length + Vec3::Constant(radius));
}

double Capsule::reach(const Pose& pose) const {
  const Vec3 end = pose.orientation * Vec3(0, 0, half_length);
  return radius + std::max((pose.position + end).norm(), (pose.position - end).norm());
}

MassProperties Capsule::mass_properties() const {
  const double r2 = radius * radius, l = half_length;
  const double barrel = 2 * pi * r2 * l, ends = 4.0 / 3 * pi * r2 * radius;
  const double along = 0.5 * barrel * r2 + 0.4 * ends * r2;
  const double across = barrel * (0.25 * r2 + l * l / 3) + ends * (0.4 * r2 + l * l + 0.75 * radius * l);
  return {barrel + ends, Vec3::Zero(), Vec3(across, across, along).asDiagonal()};
}

void Capsule::add_inner_balls(std::vector<InnerBall>& balls) const {
  constexpr int most = 64;  // half a radius apart in a capsule of up to 32 radii
  const int gaps = std::clamp(static_cast<int>(std::ceil(4 * half_length / radius)), 1, most);
  for (int i = 0; i <= gaps; ++i) balls.push_back({{0, 0, half_length * (2. * i / gaps - 1)}, radius});
}

/// The axial curvature is zero except on the end caps.
Mat3 Capsule::curvature(const Vec3& x, const Vec3& n) const {
  constexpr double rounding = 1e-12;  // contact along the side ends where the caps begin
  Mat3 k = across(n) / radius;
  if (std::abs(x[2]) <= half_length * (1 + rounding)) {
    k.row(2).setZero();
    k.col(2).setZero();
  }
  return k;
}

}  // namespace silt::rigid

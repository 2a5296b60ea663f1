#include "coupler/analytic_flow.hpp"

#include <cmath>
#include <numbers>

#include "coupler/case/case.hpp"
#include "rigid/math/elementary.hpp"

namespace silt::coupler {

using std::numbers::pi;

TaylorGreen::TaylorGreen(const Case& scene)
    : amplitude(scene.fluid->initial.velocity.norm()),
      kx(2 * pi / scene.cells[0]),
      ky(2 * pi / scene.cells[1]),
      viscosity(scene.fluid->kinematic_viscosity) {}

std::array<double, 3> TaylorGreen::velocity(double x, double y, double t) const {
  const double a = amplitude * rigid::elementary::exp(-decay_rate() * t);
  return {-a * rigid::elementary::cos(kx * x) * rigid::elementary::sin(ky * y),
          a * kx / ky * rigid::elementary::sin(kx * x) * rigid::elementary::cos(ky * y), 0};
}

double TaylorGreen::density_deviation(double x, double y, double t) const {
  const double a = amplitude * rigid::elementary::exp(-decay_rate() * t), ratio = kx / ky;
  return -0.75 * a * a *
         (rigid::elementary::cos(2 * kx * x) + ratio * ratio * rigid::elementary::cos(2 * ky * y));
}

std::array<double, 3> TaylorGreen::strain_rate(double x, double y, double t) const {
  const double a = amplitude * rigid::elementary::exp(-decay_rate() * t);
  const double xx = a * kx * rigid::elementary::sin(kx * x) * rigid::elementary::sin(ky * y);
  const double cc = rigid::elementary::cos(kx * x) * rigid::elementary::cos(ky * y);
  return {xx, -xx, 0.5 * a * (-ky + kx * kx / ky) * cc};
}

std::unique_ptr<ExactProfile> exact_profile(const Case& scene, Profile profile) {
  if (profile == Profile::pipe) return std::make_unique<PipeProfile>(scene);
  return std::make_unique<WallProfile>(scene, profile);
}

PipeProfile::PipeProfile(const Case& scene) : viscosity_(scene.fluid->kinematic_viscosity) {
  const rigid::Vec3& force = scene.fluid->body_force;
  const rigid::HollowWallSpec* const wall = scene.walls.size() == 1 ? scene.walls[0].hollow() : nullptr;
  const auto* const tube = wall ? std::get_if<rigid::Tube>(&wall->shape) : nullptr;
  if (tube) wall_ = *wall, radius_ = tube->radius;
  const bool along = force.cross(wall_.axis).norm() <= 1e-12 * force.norm();
  int axis = 0;
  wall_.axis.cwiseAbs().maxCoeff(&axis);
  if (!tube || !along || !scene.periodic(axis))
    throw CaseError(scene.place("quantities"),
                    "the profile \"pipe\" needs one tube in [[walls]], along a periodic axis, and a "
                    "fluid.body_force (if any) along it");
  acceleration_ = force.dot(wall_.axis);
}

rigid::Vec3 PipeProfile::velocity(const rigid::Vec3& x) const {
  const rigid::Vec3 from = x - wall_.point, arm = from - wall_.axis.dot(from) * wall_.axis;
  const double flow = acceleration_ * (radius_ * radius_ - arm.squaredNorm()) / (4 * viscosity_);
  return (flow + wall_.velocity) * wall_.axis + wall_.angular_velocity * wall_.axis.cross(arm);
}

double PipeProfile::largest() const {
  return std::abs(velocity(wall_.point).dot(wall_.axis)) + std::abs(wall_.angular_velocity) * radius_;
}

WallProfile::WallProfile(const Case& scene, Profile profile)
    : is_duct_(profile == Profile::duct), viscosity_(scene.fluid->kinematic_viscosity) {
  const rigid::Vec3& force = scene.fluid->body_force;
  force.cwiseAbs().maxCoeff(&flow_axis_);
  acceleration_ = force[flow_axis_];
  int walls = 0;
  for (int d = 0; d < 3; ++d) {
    size_[d] = scene.cells[d];
    if (scene.periodic(d)) continue;
    if (walls < 2) wall_axes_[walls] = d;
    ++walls;
  }
  if (acceleration_ == 0 || walls != (is_duct_ ? 2 : 1) || !scene.periodic(flow_axis_))
    throw CaseError(scene.place("quantities"),
                    "the profile \"" + std::string(profile_names[profile]) +
                        "\" needs a fluid.body_force along a periodic axis and walls across " +
                        (is_duct_ ? "the two other axes" : "exactly one other axis"));
}

double WallProfile::operator()(const std::array<double, 3>& x) const {
  const double y = x[wall_axes_[0]], height = size_[wall_axes_[0]];
  if (!is_duct_) return acceleration_ * y * (height - y) / (2 * viscosity_);
  return duct(y - height / 2, x[wall_axes_[1]] - size_[wall_axes_[1]] / 2);
}

double WallProfile::largest() const {
  std::array<double, 3> middle;
  for (int d = 0; d < 3; ++d) middle[d] = size_[d] / 2;
  return std::abs((*this)(middle));
}

/// White, Viscous Fluid Flow, eq. 3-48, for -a <= y <= a, -b <= z <= b.
double WallProfile::duct(double y, double z) const {
  constexpr int terms = 400;  // the last is below (1/800)^3 of the first
  const double a = size_[wall_axes_[0]] / 2, b = size_[wall_axes_[1]] / 2;
  double sum = 0;
  for (int n = 0, sign = 1; n < terms; ++n, sign = -sign) {
    const double i = 2 * n + 1, s = i * pi / (2 * a);
    // cosh(s z) / cosh(s b) without overflow
    const double ratio = rigid::elementary::exp(-s * (b - std::abs(z))) *
                         (1 + rigid::elementary::exp(-2 * s * std::abs(z))) /
                         (1 + rigid::elementary::exp(-2 * s * b));
    sum += sign * (1 - ratio) * rigid::elementary::cos(s * y) / (i * i * i);
  }
  return 16 * a * a * acceleration_ / (viscosity_ * pi * pi * pi) * sum;
}

}  // namespace silt::coupler

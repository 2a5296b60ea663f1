#include "coupler/analytic_flow.hpp"

#include <cmath>
#include <numbers>

#include "coupler/case/case.hpp"
#include "rigid/math/elementary.hpp"

namespace silt::coupler {

using std::numbers::pi;

TaylorGreen::TaylorGreen(const Case& setup)
    : amplitude(setup.fluid->initial.velocity.norm()),
      kx(2 * pi / setup.cells[0]),
      ky(2 * pi / setup.cells[1]),
      viscosity(setup.fluid->kinematic_viscosity) {}

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

namespace {

/// Along the body force in a tube: a (R^2 - r^2) / (4 nu) along the axis and the rigid motion of the tube.
ExactProfile pipe(const Case& setup) {
  const rigid::Vec3& force = setup.fluid->body_force;
  const rigid::HollowWallSpec* const wall = setup.walls.size() == 1 ? setup.walls[0].hollow() : nullptr;
  const auto* const tube = wall ? std::get_if<rigid::Tube>(&wall->shape) : nullptr;
  int axis = 0;
  if (tube) wall->axis.cwiseAbs().maxCoeff(&axis);
  if (!tube || !setup.periodic(axis) || force.cross(wall->axis).norm() > 1e-12 * force.norm())
    throw CaseError(setup.place("quantities"),
                    "the profile \"pipe\" needs one tube in [[walls]], along a periodic axis, and a "
                    "fluid.body_force (if any) along it");
  const double acceleration = force.dot(wall->axis), viscosity = setup.fluid->kinematic_viscosity;
  const auto velocity = [=, of = *wall, radius = tube->radius](const rigid::Vec3& x) -> rigid::Vec3 {
    const rigid::Vec3 from = x - of.point, arm = from - of.axis.dot(from) * of.axis;
    const double flow = acceleration * (radius * radius - arm.squaredNorm()) / (4 * viscosity);
    return (flow + of.velocity) * of.axis + of.angular_velocity * of.axis.cross(arm);
  };
  return {velocity,
          std::abs(velocity(wall->point).dot(wall->axis)) + std::abs(wall->angular_velocity) * tube->radius};
}

/// Of a unit acceleration over viscosity, for -a <= y <= a, -b <= z <= b: White, Viscous Fluid Flow, eq.
/// 3-48, without its factor.
double duct(double y, double z, double a, double b) {
  constexpr int terms = 400;  // the last is below (1/800)^3 of the first
  double sum = 0;
  for (int n = 0, sign = 1; n < terms; ++n, sign = -sign) {
    const double i = 2 * n + 1, s = i * pi / (2 * a);
    // cosh(s z) / cosh(s b) without overflow
    const double ratio = rigid::elementary::exp(-s * (b - std::abs(z))) *
                         (1 + rigid::elementary::exp(-2 * s * std::abs(z))) /
                         (1 + rigid::elementary::exp(-2 * s * b));
    sum += sign * (1 - ratio) * rigid::elementary::cos(s * y) / (i * i * i);
  }
  return sum;
}

/// Along the body force between the sides of a case, half way between cells.
ExactProfile between_sides(const Case& setup, Profile profile) {
  const bool is_duct = profile == Profile::duct;
  const rigid::Vec3& force = setup.fluid->body_force;
  int flow_axis = 0, walls = 0;
  force.cwiseAbs().maxCoeff(&flow_axis);
  std::array<int, 2> across{};
  for (int d = 0; d < 3; ++d) {
    if (setup.periodic(d)) continue;
    if (walls < 2) across[walls] = d;
    ++walls;
  }
  const double acceleration = force[flow_axis], viscosity = setup.fluid->kinematic_viscosity;
  if (acceleration == 0 || walls != (is_duct ? 2 : 1) || !setup.periodic(flow_axis))
    throw CaseError(setup.place("quantities"),
                    "the profile \"" + std::string(profile_names[profile]) +
                        "\" needs a fluid.body_force along a periodic axis and walls across " +
                        (is_duct ? "the two other axes" : "exactly one other axis"));
  const double height = setup.cells[across[0]], width = setup.cells[across[1]];
  const auto speed = [=](double y, double z) {
    if (!is_duct) return acceleration * y * (height - y) / (2 * viscosity);
    const double a = height / 2;
    return 16 * a * a * acceleration / (viscosity * pi * pi * pi) *
           duct(y - height / 2, z - width / 2, a, width / 2);
  };
  return {[=](const rigid::Vec3& x) -> rigid::Vec3 {
            return speed(x[across[0]], x[across[1]]) * rigid::Vec3::Unit(flow_axis);
          },
          std::abs(speed(height / 2, width / 2))};
}

}  // namespace

ExactProfile exact_profile(const Case& setup, Profile profile) {
  return profile == Profile::pipe ? pipe(setup) : between_sides(setup, profile);
}

}  // namespace silt::coupler

#include "coupler/analytic_flow.hpp"

#include <cmath>
#include <numbers>

#include "coupler/case/case.hpp"
#include "coupler/for_each_cell.hpp"
#include "lbm/lattice.hpp"

namespace silt::coupler {

using std::numbers::pi;

TaylorGreen::TaylorGreen(const Case& scene)
    : amplitude(scene.fluid->initial_velocity.norm()),
      kx(2 * pi / scene.cells[0]),
      ky(2 * pi / scene.cells[1]),
      viscosity(scene.fluid->kinematic_viscosity) {}

std::array<double, 3> TaylorGreen::velocity(double x, double y, double t) const {
  const double a = amplitude * std::exp(-decay_rate() * t);
  return {-a * std::cos(kx * x) * std::sin(ky * y), a * kx / ky * std::sin(kx * x) * std::cos(ky * y), 0};
}

double TaylorGreen::density_deviation(double x, double y, double t) const {
  const double a = amplitude * std::exp(-decay_rate() * t), ratio = kx / ky;
  return -0.75 * a * a * (std::cos(2 * kx * x) + ratio * ratio * std::cos(2 * ky * y));
}

std::array<double, 3> TaylorGreen::strain_rate(double x, double y, double t) const {
  const double a = amplitude * std::exp(-decay_rate() * t);
  const double xx = a * kx * std::sin(kx * x) * std::sin(ky * y);
  const double cc = std::cos(kx * x) * std::cos(ky * y);
  return {xx, -xx, 0.5 * a * (-ky + kx * kx / ky) * cc};
}

std::unique_ptr<ExactProfile> exact_profile(const Case& scene, Profile profile) {
  if (profile == Profile::pipe) return std::make_unique<PipeProfile>(scene);
  return std::make_unique<WallProfile>(scene, profile);
}

PipeProfile::PipeProfile(const Case& scene) : viscosity_(scene.fluid->kinematic_viscosity) {
  const rigid::Vec3& force = scene.fluid->body_force;
  if (scene.walls.size() == 1) tube_ = scene.walls[0].tube;
  const bool along = force.cross(tube_.axis).norm() <= 1e-12 * force.norm();
  int axis = 0;
  tube_.axis.cwiseAbs().maxCoeff(&axis);
  if (scene.walls.size() != 1 || !along || !scene.periodic(axis))
    throw CaseError(scene.place("quantities"),
                    "the profile \"pipe\" needs one tube in [[walls]], along a periodic axis, and a "
                    "fluid.body_force (if any) along it");
  acceleration_ = force.dot(tube_.axis);
}

rigid::Vec3 PipeProfile::velocity(const rigid::Vec3& x) const {
  const rigid::Vec3 from = x - tube_.point, arm = from - tube_.axis.dot(from) * tube_.axis;
  const double flow = acceleration_ * (tube_.radius * tube_.radius - arm.squaredNorm()) / (4 * viscosity_);
  return (flow + tube_.velocity) * tube_.axis + tube_.angular_velocity * tube_.axis.cross(arm);
}

double PipeProfile::largest() const {
  return std::abs(velocity(tube_.point).dot(tube_.axis)) + std::abs(tube_.angular_velocity) * tube_.radius;
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
    const double ratio =
        std::exp(-s * (b - std::abs(z))) * (1 + std::exp(-2 * s * std::abs(z))) / (1 + std::exp(-2 * s * b));
    sum += sign * (1 - ratio) * std::cos(s * y) / (i * i * i);
  }
  return 16 * a * a * acceleration_ / (viscosity_ * pi * pi * pi) * sum;
}

namespace {

/// The flow of a vortex at a point.
struct Local {
  double density_deviation;
  std::array<double, 3> velocity;
  double xx, yy, zz, xy, xz, yz;  // strain rate
};

Local at(const TaylorGreen& vortex, double x, double y, double) {
  const auto [xx, yy, xy] = vortex.strain_rate(x, y, 0);
  return {vortex.density_deviation(x, y, 0), vortex.velocity(x, y, 0), xx, yy, 0, xy, 0, 0};
}

/// Taylor, Green, Proc. R. Soc. A 158 (1937) 499, in a cube, at the start:
///   u = A (sin kx cos ky cos kz, -cos kx sin ky cos kz, 0),  p = A^2/16 (cos 2kx + cos 2ky)(cos 2kz + 2).
struct TaylorGreen3D {
  double amplitude, k;
  explicit TaylorGreen3D(const Case& scene)
      : amplitude(scene.fluid->initial_velocity.norm()), k(2 * pi / scene.cells[0]) {}
};

Local at(const TaylorGreen3D& vortex, double x, double y, double z) {
  const double a = vortex.amplitude, k = vortex.k;
  const double sx = std::sin(k * x), cx = std::cos(k * x), sy = std::sin(k * y), cy = std::cos(k * y);
  const double sz = std::sin(k * z), cz = std::cos(k * z), stretch = a * k * cx * cy * cz;
  const double pressure =
      a * a / 16 * (std::cos(2 * k * x) + std::cos(2 * k * y)) * (std::cos(2 * k * z) + 2);
  return {3 * pressure,
          {a * sx * cy * cz, -a * cx * sy * cz, 0},
          stretch,
          -stretch,
          0,
          0,
          -0.5 * a * k * sx * cy * sz,
          0.5 * a * k * cx * sy * sz};
}

/// Equilibrium and its first-order deviation, f1_i = -3 tau w_i (c_i c_i - 1/3) : S.
template <class Vortex>
void set_vortex(const Case& scene, Flow& flow) {
  const Vortex vortex(scene);
  const double tau = scene.fluid->relaxation_time;
  for_each_cell(flow, [&](int b, lbm::Int3 cell, lbm::Int3 global) {
    const Local l = at(vortex, global.x + 0.5, global.y + 0.5, global.z + 0.5);
    flow.set_equilibrium(b, cell, l.density_deviation, l.velocity);
    for (int i = 1; i < lbm::directions; ++i) {
      const lbm::Int3 v = lbm::c[i];
      const double strain = v.x * v.x * l.xx + v.y * v.y * l.yy + v.z * v.z * l.zz +
                            2 * (v.x * v.y * l.xy + v.x * v.z * l.xz + v.y * v.z * l.yz) -
                            (l.xx + l.yy + l.zz) / 3;
      flow.set_arriving(b, cell, i, flow.arriving(b, cell, i) - 3 * tau * lbm::w(i) * strain);
    }
  });
}

}  // namespace

void set_initial_flow(const Case& scene, Flow& flow) {
  const FluidSpec& fluid = *scene.fluid;
  if (fluid.initial == InitialFlow::taylor_green) return set_vortex<TaylorGreen>(scene, flow);
  if (fluid.initial == InitialFlow::taylor_green_3d) return set_vortex<TaylorGreen3D>(scene, flow);
  if (fluid.initial != InitialFlow::uniform) return;
  const rigid::Vec3& u = fluid.initial_velocity;
  for_each_cell(flow, [&](int b, lbm::Int3 cell, lbm::Int3) {
    flow.set_equilibrium(b, cell, 0, {u[0], u[1], u[2]});
  });
}

}  // namespace silt::coupler

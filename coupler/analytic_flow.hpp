#pragma once
// Flows with closed forms, in lattice units: what a run is compared with.
#include <array>
#include <memory>
#include <string>

#include "rigid/bodies/walls.hpp"

namespace silt::coupler {

struct Case;
enum class Profile;

/// TaylorGreen is the two-dimensional Taylor-Green vortex in the x-y plane, one wave a period:
///   u = A (-cos kx x sin ky y,  kx/ky sin kx x cos ky y) e^(-nu (kx^2 + ky^2) t),  exact for incompressible
///   flow, p = -A^2/4 (cos 2 kx x + (kx/ky)^2 cos 2 ky y) e^(-2 nu (kx^2 + ky^2) t).
struct TaylorGreen {
  double amplitude, kx, ky, viscosity;
  explicit TaylorGreen(const Case&);  // amplitude: length of fluid.initial.velocity

  double decay_rate() const { return viscosity * (kx * kx + ky * ky); }
  std::array<double, 3> velocity(double x, double y, double t) const;
  double density_deviation(double x, double y, double t) const;  // 3 p
  /// Returns the symmetric velocity gradient: xx, yy, xy.
  std::array<double, 3> strain_rate(double x, double y, double t) const;
};

/// A steady flow between walls has an exact solution, which is given here.
class ExactProfile {
 public:
  virtual ~ExactProfile() = default;
  /// Returns the velocity at a point (cell centres are at +1/2).
  virtual rigid::Vec3 velocity(const rigid::Vec3& x) const = 0;
  virtual double largest() const = 0;  // speed: what errors are relative to
};

/// Returns the flow "channel", "duct" or "pipe", from the walls and the body force of a case. CaseError if it
/// has others.
std::unique_ptr<ExactProfile> exact_profile(const Case&, Profile);

/// PipeProfile is the flow along the body force in a tube that slides and turns: a (R^2 - r^2) / (4 nu) along
/// the axis and the rigid motion of the tube.
class PipeProfile : public ExactProfile {
 public:
  explicit PipeProfile(const Case&);
  rigid::Vec3 velocity(const rigid::Vec3& x) const override;
  double largest() const override;

 private:
  rigid::HollowWallSpec wall_;
  double radius_ = 0;
  double acceleration_, viscosity_;
};

/// WallProfile is the flow along the body force between the sides of a case: "channel" (walls across one
/// axis) or "duct" (across two). Walls half way between cells.
class WallProfile : public ExactProfile {
 public:
  WallProfile(const Case&, Profile);
  rigid::Vec3 velocity(const rigid::Vec3& x) const override {
    return (*this)({x[0], x[1], x[2]}) * rigid::Vec3::Unit(flow_axis_);
  }
  /// Returns the velocity along the body force.
  double operator()(const std::array<double, 3>& x) const;
  double largest() const override;

 private:
  double duct(double y, double z) const;
  bool is_duct_;
  int flow_axis_ = 0;
  std::array<int, 2> wall_axes_{};
  double acceleration_ = 0, viscosity_ = 0;
  std::array<double, 3> size_{};
};

}  // namespace silt::coupler

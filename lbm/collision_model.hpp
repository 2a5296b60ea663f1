#pragma once
// The collision models by name, and what a run chooses: the model, its rates and the force on the fluid.
#include <array>
#include <cstdint>
#include <string_view>

namespace silt::lbm {

/// `trt` relaxes the even half of each pair of populations with 1/tau and the odd half so that
/// (tau - 1/2)(tau_odd - 1/2) = magic (Ginzburg, Verhaeghe, d'Humieres 2008); `bgk` relaxes both with 1/tau.
/// `regularised` relaxes the stress with 1/tau and replaces all else but mass and momentum (recursive
/// regularisation to third order, Malaspinas 2015): for flows that the others do not survive.
enum class Collision : std::uint8_t { trt, bgk, regularised };

/// How fast the odd half of a pair is relaxed: as `magic` says, as the even half, or at once.
enum class OddRate : std::uint8_t { by_magic, as_even, one };

struct CollisionModel {
  std::string_view name;
  OddRate odd;
  constexpr bool has_magic() const { return odd == OddRate::by_magic; }  // whether `magic` is free to choose
  constexpr bool has_eddies() const { return odd == OddRate::one; }      // whether `smagorinsky` is
};
/// The models in the order of the enumerators.
inline constexpr std::array<CollisionModel, 3> collision_models = {
    {{"trt", OddRate::by_magic}, {"bgk", OddRate::as_even}, {"regularised", OddRate::one}}};
constexpr const CollisionModel& model_of(Collision collision) {
  return collision_models[static_cast<std::size_t>(collision)];
}

struct CollisionSpec {
  double relaxation_time = 1;
  double magic = 1.0 / 6;  // ignored by models without one
  Collision model = Collision::trt;
  std::array<double, 3> force{};  // acceleration of the fluid, uniform
  double smagorinsky = 0;         // constant of the least viscosity of a cell (README.md, equation 28)

  /// tau_odd.
  constexpr double odd_relaxation_time() const {
    switch (model_of(model).odd) {
      case OddRate::by_magic:
        return 0.5 + magic / (relaxation_time - 0.5);
      case OddRate::as_even:
        return relaxation_time;
      case OddRate::one:
        return 1;
    }
    __builtin_unreachable();
  }
  /// (tau - 1/2)(tau_odd - 1/2).
  constexpr double magic_in_effect() const {
    return model_of(model).has_magic() ? magic : (relaxation_time - 0.5) * (odd_relaxation_time() - 0.5);
  }
};

}  // namespace silt::lbm

#pragma once
// The collision models by name, and what a run chooses: the model, its rates and the force on the fluid.
#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

namespace silt::lbm {

/// `trt` relaxes the even half of each pair of populations with 1/tau and the odd half so that
/// (tau - 1/2)(tau_odd - 1/2) = magic (Ginzburg, Verhaeghe, d'Humieres 2008); `bgk` relaxes both with 1/tau.
/// `regularised` relaxes the stress with 1/tau, third moments as trt does but no slower than it may, and
/// replaces all else but mass and momentum (method.md, equations 24 to 27): for flows that the others do not
/// survive.
enum class Collision : std::uint8_t { trt, bgk, regularised };

/// How fast the odd half of a pair is relaxed: as `magic` says, as the even half, or as `magic` says as long
/// as that is stable.
enum class OddRate : std::uint8_t { by_magic, as_even, by_magic_if_stable };

struct CollisionModel {
  std::string_view name;
  OddRate odd;
  double lasts_to;  // u / nu of a cell up to which five small scenes last (scripts/bench stability)
  /// Whether `magic` is free to choose.
  constexpr bool has_magic() const { return odd != OddRate::as_even; }
  /// Whether `smagorinsky` is.
  constexpr bool has_eddies() const { return odd == OddRate::by_magic_if_stable; }
};
/// The models in the order of the enumerators.
inline constexpr std::array<CollisionModel, 3> collision_models = {
    {{"trt", OddRate::by_magic, 10},
     {"bgk", OddRate::as_even, 10},
     {"regularised", OddRate::by_magic_if_stable, 3000}}};
constexpr const CollisionModel& model_of(Collision collision) {
  return collision_models[static_cast<std::size_t>(collision)];
}

struct CollisionSpec {
  double relaxation_time = 1;
  double magic = 1.0 / 6;  // ignored by models without one
  Collision model = Collision::trt;
  std::array<double, 3> force{};  // acceleration of the fluid, uniform
  double smagorinsky = 0;         // constant of the least viscosity of a cell (method.md, equation 28)

  constexpr double excess() const { return relaxation_time - 0.5; }
  /// How much `regularised` relaxes third and fourth moments as trt does: not at all where that amplifies
  /// (method.md, equation 26).
  constexpr double ghosts_as_trt() const { return std::clamp((excess() - 0.05) / 0.05, 0.0, 1.0); }
  /// tau_odd as `magic` says, as far as that is stable.
  constexpr double stable_odd_relaxation_time() const {
    return 1 + std::min(magic / excess() - 0.5, 0.0) +
           ghosts_as_trt() * std::max(magic / excess() - 0.5, 0.0);
  }
  /// tau_odd.
  constexpr double odd_relaxation_time() const {
    switch (model_of(model).odd) {
      case OddRate::by_magic:
        return 0.5 + magic / excess();
      case OddRate::as_even:
        return relaxation_time;
      case OddRate::by_magic_if_stable:
        return stable_odd_relaxation_time();
    }
    __builtin_unreachable();
  }
  /// (tau - 1/2)(tau_odd - 1/2).
  constexpr double magic_in_effect() const {
    return model_of(model).odd == OddRate::by_magic ? magic : excess() * (odd_relaxation_time() - 0.5);
  }
};

}  // namespace silt::lbm

#pragma once
// The collision models by name, and the choices of a run: the model, its rates and the force on the fluid.
#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

namespace silt::lbm {

/// `trt` relaxes the even half of each pair with 1/tau and the odd half such that (tau - 1/2)(tau_odd - 1/2)
/// = magic (Ginzburg, Verhaeghe, d'Humieres 2008). `bgk` relaxes both with 1/tau. `regularised` relaxes the
/// stress with 1/tau and third moments as trt does but no slower than is stable, and replaces all others but
/// mass and momentum (method.md, equations 24 to 27), for flows unstable with the others.
enum class Collision : std::uint8_t { trt, bgk, regularised };

/// How the odd half of a pair relaxes: by `magic`, as the even half, or by `magic` if that is stable.
enum class OddRate : std::uint8_t { by_magic, as_even, by_magic_if_stable };

struct CollisionModel {
  std::string_view name;
  OddRate odd;
  double lasts_to;  // largest stable u / nu of a cell in five small scenes (scripts/bench stability)
  constexpr bool has_magic() const { return odd != OddRate::as_even; }
  /// Returns whether the model uses `smagorinsky`.
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
  double magic = 1.0 / 6;  // ignored by models without it
  Collision model = Collision::trt;
  std::array<double, 3> force{};  // uniform acceleration of the fluid
  double smagorinsky = 0;         // Smagorinsky constant of eddies (method.md, equation 28)

  constexpr double excess() const { return relaxation_time - 0.5; }
  /// Returns the share to which `regularised` relaxes high moments like trt (method.md, equation 26).
  constexpr double ghosts_as_trt() const { return std::clamp((excess() - 0.05) / 0.05, 0.0, 1.0); }
  /// Returns the part of the even half that outlets reverse (method-fluid.md, equation 28a).
  constexpr double reversed_at_outlets() const {
    return 0.5 + 0.5 * std::clamp((excess() - 0.03) / 0.02, 0.0, 1.0);
  }
  /// Returns tau_odd from `magic`, limited to what is stable.
  constexpr double stable_odd_relaxation_time() const {
    return 1 + std::min(magic / excess() - 0.5, 0.0) +
           ghosts_as_trt() * std::max(magic / excess() - 0.5, 0.0);
  }
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
  /// Returns the share of bulk stress that cells at walls give up with their excess (method.md, equation 9b).
  constexpr double bulk_stress_given_up() const {
    return std::clamp((0.53 - relaxation_time) / 0.01, 0.0, 1.0);
  }
  /// Returns (tau - 1/2)(tau_odd - 1/2).
  constexpr double magic_in_effect() const {
    return model_of(model).odd == OddRate::by_magic ? magic : excess() * (odd_relaxation_time() - 0.5);
  }
};

template <class T>
struct HeatRates;

/// Rates for a diagonal direction (w = 1/36): twice these along an axis, twelve times at rest. So that
/// rounding neither makes nor destroys mass or momentum steadily, the rates of density and momentum are
/// multiples of a number so small that the kept fractions of populations are exact.
template <class T>
struct CollisionRates {
  using Number = T;
  Collision model;
  T density;                               // omega_even/36, of rho
  T square;                                // omega_even/24, of u_d u_d, for the even half
  T momentum;                              // omega_odd/12, of u
  T keep_even, keep_even_twice, keep_odd;  // (1 - omega)/2
  T half_force[3], even_force[3], odd_force[3];
  T keep_third,
      keep_fourth;    // of regularised: what is left of moments beyond those that follow from the stress
  T resolved_square;  // half the squared stress off equilibrium above which eddies add viscosity
  T eddy;             // 9 C^2; 0: none
  const HeatRates<T>* heat = nullptr;  // of the temperature that the fluid carries; null: none

  /// Throws std::invalid_argument for a relaxation time of 1/2 or less.
  explicit CollisionRates(const CollisionSpec&);
  bool has_force() const { return half_force[0] != 0 || half_force[1] != 0 || half_force[2] != 0; }
};

}  // namespace silt::lbm
